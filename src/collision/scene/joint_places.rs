//! Where the joints of a machine stand in the positions of a system.

use std::collections::HashMap;

use crate::robot::{Chain, Joint, JointSource};

/// Which joints of a machine are entries of a system's positions, and where the others stay.
///
/// ```
/// use kinstep::collision::JointPlaces;
/// use kinstep::robot::{JointSource, embedded};
/// let panda = embedded::get("panda")?;
/// let chain = panda.chain("panda_link0", "panda_hand_tcp")?;
/// let places = JointPlaces::new().with_arm(&chain, &[7, 8, 9, 10, 11, 12, 13]).holding("panda_finger_joint1", 0.04);
/// let of = |name: &str| places.source(panda.joint(name).expect("it is there"));
/// assert_eq!(of("panda_joint2"), JointSource::Column(8));
/// assert_eq!(of("panda_finger_joint1"), JointSource::Held(0.04));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct JointPlaces {
    sources: HashMap<String, JointSource>,
}

impl JointPlaces {
    /// Returns places of no joint: all stay where zero is, or at the limit that is nearest to it.
    pub fn new() -> JointPlaces {
        JointPlaces::default()
    }

    /// Returns the places in which the joints of a chain are those entries of the system's positions. Arms that share joints give
    /// them the same place.
    ///
    /// # Panics
    /// When there is not one place for every joint of the chain.
    #[must_use]
    pub fn with_arm(mut self, chain: &Chain, places: &[usize]) -> JointPlaces {
        assert_eq!(places.len(), chain.dof(), "one place per joint of the chain");
        let named = chain.joints().iter().zip(places);
        self.sources.extend(named.map(|(joint, place)| (joint.name.clone(), JointSource::Column(*place))));
        self
    }

    /// Returns the places in which a joint stays at a position \[rad\] or \[m\].
    #[must_use]
    pub fn holding(mut self, joint: &str, position: f64) -> JointPlaces {
        self.sources.insert(joint.to_owned(), JointSource::Held(position));
        self
    }

    /// Returns where the position of a joint comes from.
    pub fn source(&self, joint: &Joint) -> JointSource {
        let nearest_to_zero = || JointSource::Held(0.0_f64.max(joint.limits.lower).min(joint.limits.upper));
        self.sources.get(&joint.name).copied().unwrap_or_else(nearest_to_zero)
    }
}
