//! The laws that a build contains. Every build has the plain spring. Each other law has a feature of this crate. Without the
//! feature a type without code replaces the law, so that firmware contains only the laws that it can choose.

use super::{Law, Sample, View};
use crate::{Force, LawKind, Number, SettingsError};
use core::convert::Infallible;
use core::marker::PhantomData;

/// For each law, the law and its memory if the build has its feature; else types without code under the same names.
macro_rules! laws {
    ($($feature:literal: $Law:ident, $State:ident;)+) => {$(
        #[cfg(feature = $feature)]
        pub(crate) use super::{$Law, $State};
        /// Replaces a law that this build leaves out.
        #[cfg(not(feature = $feature))]
        pub type $Law<N> = LeftOut<super::$Law<N>>;
        /// Replaces the memory of a law that this build leaves out.
        #[cfg(not(feature = $feature))]
        pub type $State<N> = NoMemory<N>;
    )+};
}
laws! {
    "spring-damper": Damped, DampedState;
    "tdpa": Tdpa, TdpaState;
    "fba": Fba, FbaState;
    "sfa": Sfa, SfaState;
    "enhanced-sfa": EnhancedSfa, EnhancedState;
}

/// Replaces the law `L` in a build without it: no value of this type exists.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeftOut<L> {
    never: Infallible,
    law: PhantomData<L>,
}

/// Memory of [`LeftOut`]: none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NoMemory<N>(PhantomData<N>);

impl<N: Number, L: Law<N>> Law<N> for LeftOut<L> {
    type State = NoMemory<N>;

    fn tick(&self, _: &mut NoMemory<N>, _: Sample<N>) -> Force<N> {
        match self.never {}
    }

    fn view(&self, _: &NoMemory<N>) -> View<N> {
        match self.never {}
    }
}

/// The type that a build has for the law `L`: the law itself, or [`LeftOut`], whose constructor returns an error.
pub(crate) trait Kept<L>: Sized {
    /// Computes the coefficients of the law; an error for a law that the build leaves out.
    fn kept(
        kind: LawKind,
        make: impl FnOnce() -> Result<L, SettingsError>,
    ) -> Result<Self, SettingsError>;
}

impl<L> Kept<L> for L {
    #[inline(always)]
    fn kept(
        _: LawKind,
        make: impl FnOnce() -> Result<L, SettingsError>,
    ) -> Result<L, SettingsError> {
        make()
    }
}

impl<L> Kept<L> for LeftOut<L> {
    #[inline(always)]
    fn kept(
        law: LawKind,
        _: impl FnOnce() -> Result<L, SettingsError>,
    ) -> Result<Self, SettingsError> {
        Err(SettingsError::LawLeftOut { law })
    }
}
