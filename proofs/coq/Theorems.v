(** What is claimed, and that nothing is assumed for it: the gate counts the answers. *)

From Touchstone Require Import Port GuardLosesNothing Shipped AcceptedIsValid AcceptedCovers AcceptedWindow LawsArePassive Mass
  EnhancedIsPassive EnhancedOffset EnhancedStorage EnhancedPort.

Print Assumptions change_of_force.
Print Assumptions pure_delay_acts_late.
Print Assumptions current_loop_acts_late.
Print Assumptions any_window.
Print Assumptions any_window_by_settings.
Print Assumptions knob_acts_late.
Print Assumptions shipped_window.
Print Assumptions accepted_is_valid.
Print Assumptions accepted_covers.
Print Assumptions no_worse_is_covered.
Print Assumptions any_accepted_window.
Print Assumptions thesis_sum_is_never_negative.
Print Assumptions fba_is_passive.
Print Assumptions contact_gives_at_most_the_loan.
Print Assumptions given_at_most.
Print Assumptions enhanced_gives_at_most_the_loan.
Print Assumptions enhanced_gives_at_most.
Print Assumptions enhanced_energy_is_never_negative.
Print Assumptions offset_in_a_tick.
Print Assumptions offset_goes_no_further.
Print Assumptions storage_is_kept.
Print Assumptions force_is_the_tension_rounded.
Print Assumptions hand_over_adds_nothing.
Print Assumptions contact_gives_at_most_what_it_took.
