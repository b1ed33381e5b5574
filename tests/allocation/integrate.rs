//! Steps of varying length and order.

use allocation_counter::measure;
use kinstep::integrate::{Family, Ode, VariableOrder};

/// From the first step on, whatever the family: also steps that are rejected, Jacobians and changes of order.
#[test]
fn steps_of_varying_order_allocate_nothing() {
    for family in Family::ALL {
        let mut field = Ode::new(2, |_t, x: &[f64], f: &mut [f64]| {
            f[0] = x[1];
            f[1] = 100.0 * (1.0 - x[0] * x[0]) * x[1] - x[0];
        });
        let mut stepper =
            VariableOrder::new(family, &mut field, 0.0, &[2.0, 0.0], 1000.0, 1e-6, &[1e-6]).unwrap();
        let mut state = [0.0; 2];
        let allocated = measure(|| {
            for _ in 0..500 {
                assert_eq!(stepper.advance(&mut field), None);
                stepper.state_at(stepper.time() - 0.5 * stepper.last_step(), &mut state);
            }
        });
        assert_eq!(allocated.count_total, 0, "{family}");
        let statistics = stepper.statistics();
        assert!(statistics.rejected > 0 && statistics.orders.iter().filter(|steps| **steps > 0).count() > 3);
    }
}
