//! Largest energy that a port gives out in any window of time.

/// Most energy that a port gave out in any window of time: the largest fall of the absorbed energy below an earlier value.
///
/// In a sum from the start, energy put in early would hide energy given out later; a window may begin and end at any tick. A spring
/// gives back what it stored, so even a passive wall has a value above 0: the energy of its deepest press.
#[derive(Debug, Clone, Copy, Default)]
pub struct WorstWindow {
    highest_j: f64,
    worst_j: f64,
}

impl WorstWindow {
    /// Adds a tick. `absorbed_j` is the energy that the port has absorbed since the start of the run, J; it starts at 0.
    pub fn record(&mut self, absorbed_j: f64) {
        self.highest_j = self.highest_j.max(absorbed_j);
        self.worst_j = self.worst_j.max(self.highest_j - absorbed_j);
    }

    /// Most energy that the port gave out in any window, J, 0 or more.
    #[must_use]
    pub fn worst_j(&self) -> f64 {
        self.worst_j
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(energies: impl IntoIterator<Item = f64>) -> f64 {
        let mut window = WorstWindow::default();
        energies.into_iter().for_each(|j| window.record(j));
        window.worst_j()
    }

    #[test]
    fn a_spring_gives_back_what_its_deepest_press_stored() {
        let (k, a) = (5.0, 0.02);
        let stored = (0..1_000).map(|step| {
            let depth = a * (f64::from(step) * 0.01).sin();
            0.5 * k * depth * depth
        });
        assert!((worst(stored) / (0.5 * k * a * a) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn what_was_put_in_first_does_not_hide_what_is_given_later() {
        assert_eq!(worst([10.0, 7.0, 9.0, 3.0, 4.0]), 7.0);
        // The energy never falls below its start, so a sum from the start would show no energy given out.
        assert_eq!(worst([-2.0, -1.0, -4.0]), 4.0, "the start is 0");
    }

    #[test]
    fn a_damper_gives_nothing() {
        assert_eq!(worst((0..100).map(f64::from)), 0.0);
        assert_eq!(worst([]), 0.0);
    }
}
