//! The settings that are one of a few words. The place of a word is its number on the wire, so new ones go to the end.

pub use crate::observer::ObserverForm;

crate::choice! {
    /// Which law.
    LawKind {
        /// Virtual spring (1.6).
        Spring = "spring",
        /// Virtual spring with virtual damping (§1.2.6).
        SpringDamper = "spring-damper",
        /// Time-domain passivity approach.
        Tdpa = "tdpa",
        /// Force bounding approach.
        Fba = "fba",
        /// Original successive force augmentation.
        Sfa = "sfa",
        /// Successive force augmentation with the offset changed at every inward tick.
        SfaContinuous = "sfa-continuous",
        /// Enhanced successive force augmentation.
        #[default]
        EnhancedSfa = "enhanced-sfa",
    }
}

crate::choice! {
    /// What happens to the force when the first contact ends.
    FirstContact {
        /// The offset is set so that the force goes on (2.17).
        KeepForce = "keep-force",
        /// The offset stays zero and the force drops to the soft spring's (§3.2): the stable choice.
        #[default]
        ZeroOffset = "zero-offset",
    }
}

crate::choice! {
    /// Which stiffness the offset regulates.
    Regulate {
        /// Force over position of the virtual mass, towards `k_de`: the HIP feels less, by (3.4).
        Mass = "mass",
        /// The same, towards the stiffness of (3.5), so that the HIP feels `k_de`; needs `k_de < k_f`.
        MassCompensated = "mass-compensated",
        /// Force over position of the HIP, towards `k_de` (3.6).
        #[default]
        Hip = "hip",
    }
}

crate::choice! {
    /// When the offset is changed.
    OffsetUpdate {
        /// When the motion turns from outward to inward (2.14).
        TurnInward = "turn-inward",
        /// At every inward tick (3.2, Algorithm 3.1).
        Inward = "inward",
        /// At every tick of contact, in the direction of the error. Inward-only is a ratchet: it moves on only as long as
        /// something jitters, and overshoots what it cannot take back.
        #[default]
        EveryTick = "every-tick",
    }
}

crate::choice! {
    /// What the offset's ideal step supposes of the hand.
    IdealStep {
        /// The position stays: `|k_de e - |f||/k_v` (3.7). A soft hand gives way by as much as the offset grows, so that this
        /// step is too long by `k_de/k_v`, and `c` must be chosen anew for every `k_de`.
        Position = "position",
        /// The force stays and the position follows the offset: `|e - |f|/k_de|`, the way that the HIP still has to go. One `c`
        /// then serves all stiffnesses.
        #[default]
        Force = "force",
    }
}

crate::choice! {
    /// What the law is told of position and velocity.
    StatesKind {
        /// The measured penetration, and its change since the last tick.
        #[default]
        Measured = "measured",
        /// What an estimator makes of it, for the time at which the force will act.
        Estimated = "estimated",
    }
}

crate::choice! {
    /// What the law spring-damper takes for the velocity.
    VelocityKind {
        /// What every law is told: the difference of two positions, or the estimator's.
        #[default]
        Told = "told",
        /// The difference through a first-order filter.
        Filtered = "filtered",
        /// First-order adaptive windowing (Janabi-Sharifi, Hayward and Chen 2000).
        Foaw = "foaw",
        /// A Kalman filter for constant velocity, in its steady state.
        Kalman = "kalman",
        /// The same for constant acceleration.
        KalmanAcceleration = "kalman-acceleration",
    }
}

crate::choice! {
    /// What is known of the position at the instant at which a new force takes the place of the old one.
    ChangeOfForce {
        /// Nothing: positions are taken once a tick. Each change of force is charged for what can have happened.
        #[default]
        Estimated = "estimated",
        /// It is measured as well, `delay` after the tick: nothing is charged for the delay.
        Measured = "measured",
    }
}
