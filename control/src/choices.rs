//! The settings that are one of a few words. The place of a word is its number on the wire, so new ones go to the end.

pub use crate::observer::ObserverForm;

crate::choice! {
    /// The law in use.
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
    /// The stiffness that the offset regulates.
    Regulate {
        /// Force over position of the virtual mass, towards `k_de`: the HIP feels less, by (3.4).
        Mass = "mass",
        /// As `mass`, but regulated to the stiffness of (3.5), so that the HIP feels `k_de`; needs `k_de < k_f`.
        MassCompensated = "mass-compensated",
        /// Force over position of the HIP, towards `k_de` (3.6).
        #[default]
        Hip = "hip",
    }
}

crate::choice! {
    /// The moments at which the offset is changed.
    OffsetUpdate {
        /// The offset changes when the motion turns from outward to inward (2.14).
        TurnInward = "turn-inward",
        /// The offset changes at every inward tick (3.2, Algorithm 3.1).
        Inward = "inward",
        /// At every tick of contact, in the direction of the error. Inward-only is a ratchet: it moves on only as long as
        /// something jitters, and overshoots what it cannot take back.
        #[default]
        EveryTick = "every-tick",
    }
}

crate::choice! {
    /// The assumption about the hand behind the step of the offset.
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
    /// The position and velocity that the law gets.
    StatesKind {
        /// The measured penetration, and its change since the last tick.
        #[default]
        Measured = "measured",
        /// The estimator's prediction for the time at which the force will act.
        Estimated = "estimated",
    }
}

crate::choice! {
    /// The velocity that the law spring-damper uses.
    VelocityKind {
        /// The displacement that every law gets: the difference of two positions, or the estimator's.
        #[default]
        Told = "told",
        /// The difference through a first-order filter.
        Filtered = "filtered",
        /// First-order adaptive windowing (Janabi-Sharifi, Hayward and Chen 2000).
        Foaw = "foaw",
        /// A Kalman filter for constant velocity, in its steady state.
        Kalman = "kalman",
        /// A steady Kalman filter for constant acceleration.
        KalmanAcceleration = "kalman-acceleration",
    }
}

crate::choice! {
    /// How the position is known at the instant at which a new force replaces the old one.
    ChangeOfForce {
        /// Nothing: positions are taken once a tick. Each change of force is charged for what can have happened.
        #[default]
        Estimated = "estimated",
        /// The position is measured a second time, `delay` after the tick, so the guard charges nothing for the delay.
        Measured = "measured",
    }
}
