(** What is claimed, and that nothing is assumed for it: the gate counts the answers. *)

From Touchstone Require Import Port GuardLosesNothing Shipped.

Print Assumptions change_of_force.
Print Assumptions any_window.
Print Assumptions any_window_by_settings.
Print Assumptions shipped_window.
