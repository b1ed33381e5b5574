//! The stepper: evaluates, predicts, corrects, and accepts or rejects.
//!
//! ```text
//! evaluate   f_n = f(t_n, x_n), g_n = g(t_n, x_n)                                       kept in the history
//! predict    candidate = sum_{j=1..s} (-alpha_j x + sigma beta_j f + sigma gamma_j g)_{n+1-j}
//! correct    explicit: nothing; implicit: solves for the candidate; pair: evaluates and corrects it
//! accept     x_{n+1} = candidate, t_{n+1} = t_n + sigma                                 kept in the history
//! reject     nothing is kept; the step is predicted anew, with another length
//! ```

mod correction;
mod multistep;
mod next_state;
mod phase;

pub use multistep::Multistep;
