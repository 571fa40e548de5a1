//! Settings whose value is one word of a fixed list, such as the name of a control law. On the wire a word is sent as its index in
//! the list, so new words are added at the end.

pub use crate::observer::ObserverForm;

crate::choice! {
    /// The control law in use. Numbers in brackets are equations and sections of the thesis (`CITATION.cff`), whose control laws
    /// this crate implements.
    LawKind {
        /// Virtual spring: force in proportion to the penetration, equation (1.6) of the thesis.
        Spring = "spring",
        /// Virtual spring with virtual damping, §1.2.6 of the thesis.
        SpringDamper = "spring-damper",
        /// Time-domain passivity approach (TDPA): reduces the force if the wall would give more energy than it took.
        Tdpa = "tdpa",
        /// Force bounding approach (FBA): limits the force to what the energy put in and the device's damping cover.
        Fba = "fba",
        /// Original successive force augmentation (SFA): a soft spring whose offset grows in steps until the force is that of the
        /// stiff wall.
        Sfa = "sfa",
        /// Successive force augmentation whose offset changes at every tick (control period) of inward motion.
        SfaContinuous = "sfa-continuous",
        /// Enhanced successive force augmentation (SFA): the augmentation acts on a virtual mass, whose energy is summed exactly.
        #[default]
        EnhancedSfa = "enhanced-sfa",
    }
}

crate::choice! {
    /// For the laws of successive force augmentation: what happens to the force when the first contact ends, that is when the
    /// motion reverses for the first time.
    FirstContact {
        /// The offset (extra deformation) of the soft spring is set so that the force continues without a jump, equation (2.17) of
        /// the thesis.
        KeepForce = "keep-force",
        /// The offset stays zero, so the force drops from that of the desired stiffness `k_de` to that of the soft spring `k_v`
        /// (§3.2 of the thesis). This choice is the stable one.
        #[default]
        ZeroOffset = "zero-offset",
    }
}

crate::choice! {
    /// The stiffness that the enhanced law keeps near the desired stiffness `k_de`, by changing the offset of its soft spring.
    Regulate {
        /// The stiffness at the virtual mass: the wall's force on the mass over the mass' penetration. A spring connects the
        /// hand's point (HIP) to that mass, so the hand feels less than `k_de`, by equation (3.4) of the thesis.
        Mass = "mass",
        /// As `mass`, but with the higher target stiffness of equation (3.5) of the thesis, so that the hand's point (HIP) feels
        /// `k_de`. Needs `k_de` below the stiffness `k_f` of the spring between HIP and mass.
        MassCompensated = "mass-compensated",
        /// The stiffness at the hand's point (HIP): the force on it over its penetration, equation (3.6) of the thesis.
        #[default]
        Hip = "hip",
    }
}

crate::choice! {
    /// The ticks (control periods) in which a law of force augmentation changes the offset of its soft spring.
    OffsetUpdate {
        /// The offset changes when the motion turns from outward to inward, equation (2.14) of the thesis. The enhanced law
        /// treats this choice like `inward`.
        TurnInward = "turn-inward",
        /// The offset changes at every tick of inward motion, equation (3.2) and Algorithm 3.1 of the thesis.
        Inward = "inward",
        /// The offset changes at every tick of contact, up or down, by the error of the stiffness. With the other two choices the
        /// offset changes on inward motion only. So while the hand rests, only jitter of the measured position changes the
        /// offset, and an offset that is too large stays.
        #[default]
        EveryTick = "every-tick",
    }
}

crate::choice! {
    /// The assumption about the hand that determines the enhanced law's ideal step of the offset: the step that would make the
    /// stiffness right at once.
    IdealStep {
        /// The hand's position stays constant. With desired stiffness `k_de`, penetration `e`, force `f` and soft stiffness `k_v`,
        /// the step is `|k_de e - |f||/k_v`, equation (3.7) of the thesis.
        ///
        /// A soft hand gives way by as much as the offset grows. So this step is too long by the factor `k_de/k_v`. The law takes
        /// a fraction `c` of the step per tick (`step_of_ideal`), which must be chosen anew for every `k_de`.
        Position = "position",
        /// The hand's force `f` stays constant and the penetration `e` follows the offset. With a desired stiffness `k_de` the
        /// step is `|e - |f|/k_de|`, the distance that the hand still has to go. The same fraction `c` of this step per tick then
        /// suits all stiffnesses.
        #[default]
        Force = "force",
    }
}

crate::choice! {
    /// Where the position and velocity that the control law uses come from.
    StatesKind {
        /// The measured penetration, and its change since the last tick.
        #[default]
        Measured = "measured",
        /// The state estimator's prediction for the time at which the calculated force will act.
        Estimated = "estimated",
    }
}

crate::choice! {
    /// How the law spring-damper gets the velocity that its damper uses.
    VelocityKind {
        /// No filter: the displacement per tick that every law gets. It is the difference of two measured positions or the state
        /// estimator's.
        #[default]
        Told = "told",
        /// The difference of two positions through a first-order low-pass filter.
        Filtered = "filtered",
        /// First-order adaptive windowing (Janabi-Sharifi, Hayward and Chen 2000).
        Foaw = "foaw",
        /// A Kalman filter with constant gains (its steady state) that assumes a constant velocity.
        Kalman = "kalman",
        /// A Kalman filter with constant gains (its steady state) that assumes a constant acceleration.
        KalmanAcceleration = "kalman-acceleration",
    }
}

crate::choice! {
    /// How the energy guard learns the position at the instant, between two ticks, at which a new force replaces the old one.
    ChangeOfForce {
        /// The position is measured only once a tick. So at each change of force the guard takes from its energy account the most
        /// energy that a hand can have gained by the change.
        #[default]
        Estimated = "estimated",
        /// The position is measured a second time in the tick, when the force changes (`delay` after the first measurement). So the
        /// guard takes nothing from its energy account for the delay.
        Measured = "measured",
    }
}
