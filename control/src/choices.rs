//! The settings that are one of a few words, such as the kind of control law. On the wire a word is its place in the list, so new
//! words go to the end.

pub use crate::observer::ObserverForm;

crate::choice! {
    /// The control law in use. Numbers in brackets are equations and sections of the thesis on which this crate builds.
    LawKind {
        /// Virtual spring, equation (1.6) of the thesis.
        Spring = "spring",
        /// Virtual spring with virtual damping, §1.2.6 of the thesis.
        SpringDamper = "spring-damper",
        /// Time-domain passivity approach (TDPA): reduces the force where the wall would give more energy than it took.
        Tdpa = "tdpa",
        /// Force bounding approach (FBA): limits the force to what the device's damping can absorb.
        Fba = "fba",
        /// Original successive force augmentation (SFA): a soft spring whose offset grows in steps until the force is that of the
        /// stiff wall.
        Sfa = "sfa",
        /// Successive force augmentation whose offset changes at every tick (control period) of inward motion.
        SfaContinuous = "sfa-continuous",
        /// Enhanced successive force augmentation: SFA behind a virtual mass, with an exact energy sum.
        #[default]
        EnhancedSfa = "enhanced-sfa",
    }
}

crate::choice! {
    /// What happens to the force when the first contact ends, that is when the motion reverses for the first time.
    FirstContact {
        /// The offset of the soft spring is set so that the force continues without a jump, equation (2.17) of the thesis.
        KeepForce = "keep-force",
        /// The offset stays zero, so the force drops to that of the soft spring `k_v` (§3.2 of the thesis). This choice is the
        /// stable one.
        #[default]
        ZeroOffset = "zero-offset",
    }
}

crate::choice! {
    /// The stiffness that the law regulates by changing the offset of the soft spring.
    Regulate {
        /// Force over position of the virtual mass, regulated towards `k_de`. The hand's point (HIP) feels less than `k_de`, by
        /// equation (3.4) of the thesis.
        Mass = "mass",
        /// As `mass`, but regulated to the stiffness of equation (3.5) of the thesis, so that the hand's point (HIP) feels `k_de`.
        /// Needs `k_de < k_f`.
        MassCompensated = "mass-compensated",
        /// Force over position of the hand's point (HIP), regulated towards `k_de`, equation (3.6) of the thesis.
        #[default]
        Hip = "hip",
    }
}

crate::choice! {
    /// The ticks (control periods) in which the law changes the offset of its soft spring.
    OffsetUpdate {
        /// The offset changes when the motion turns from outward to inward, equation (2.14) of the thesis.
        TurnInward = "turn-inward",
        /// The offset changes at every tick of inward motion, equation (3.2) and Algorithm 3.1 of the thesis.
        Inward = "inward",
        /// The offset changes at every tick of contact, in the direction of the stiffness error. With the inward-only choices the
        /// offset can only grow: it advances only while the position jitters, and an overshoot stays.
        #[default]
        EveryTick = "every-tick",
    }
}

crate::choice! {
    /// The assumption about the hand from which the law calculates the offset's ideal step.
    IdealStep {
        /// The hand's position stays constant: the step is `|k_de e - |f||/k_v`, equation (3.7) of the thesis. A soft hand gives
        /// way by as much as the offset grows. So this step is too long by the factor `k_de/k_v`, and the fraction `c` must be
        /// chosen anew for every `k_de`.
        Position = "position",
        /// The hand's force stays constant and the position follows the offset: the step is `|e - |f|/k_de|`, the distance that the
        /// HIP still has to go. One fraction `c` of the step then serves all stiffnesses.
        #[default]
        Force = "force",
    }
}

crate::choice! {
    /// The source of the position and velocity that the control law uses.
    StatesKind {
        /// The position and velocity come from the measured penetration and its change since the last tick.
        #[default]
        Measured = "measured",
        /// The state estimator's prediction for the time at which the calculated force will act.
        Estimated = "estimated",
    }
}

crate::choice! {
    /// The velocity that the law spring-damper uses.
    VelocityKind {
        /// The plain displacement per tick that every law gets: the difference of two measured positions, or the state estimator's.
        #[default]
        Told = "told",
        /// The difference of two positions through a first-order low-pass filter.
        Filtered = "filtered",
        /// First-order adaptive windowing (Janabi-Sharifi, Hayward and Chen 2000).
        Foaw = "foaw",
        /// A Kalman filter in its steady state that assumes a constant velocity.
        Kalman = "kalman",
        /// A Kalman filter in its steady state that assumes a constant acceleration.
        KalmanAcceleration = "kalman-acceleration",
    }
}

crate::choice! {
    /// How the energy guard knows the position at the instant at which a new force replaces the old one.
    ChangeOfForce {
        /// The position is measured once a tick only. For each change of force the guard charges the most energy that a hand can
        /// have got out of it.
        #[default]
        Estimated = "estimated",
        /// The position is measured a second time, `delay` after the tick, when the force changes. So the guard charges nothing for
        /// the delay.
        Measured = "measured",
    }
}
