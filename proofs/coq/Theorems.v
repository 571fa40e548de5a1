(** Prints the definitions that the claims use, the claims, and what they assume: nothing. The gate (cargo xtask prove --theorems)
    compares what Coq prints with claims.txt. So no claim can be removed or weakened without a change of that file. compare.ml
    compares the definitions of a tick of guard and laws with the code. *)

Require Import ZArith QArith Qabs Qminmax List.
From Touchstone Require Import Quotient Root Guard Port GuardLosesNothing ToldChange Shipped GuardSettings AcceptedIsValid AcceptedCovers
  AcceptedWindow Hand Laws LawsArePassive Mass Enhanced EnhancedIsPassive EnhancedOffset EnhancedStorage EnhancedPort.

Open Scope Q_scope.
Set Printing Width 140.

(** * Definitions that the claims use *)

Print Port.part_of_tick.
Print Port.acts_late.
Print Port.step_response.
Print Port.mean.
Print Port.piece.
Print Port.sum.
Print GuardLosesNothing.device.
Print GuardLosesNothing.largest.
Print GuardLosesNothing.covers.
Print GuardLosesNothing.world.
Print GuardLosesNothing.event.
Print GuardLosesNothing.possible.
Print GuardLosesNothing.port.
Print GuardLosesNothing.after.
Print GuardLosesNothing.run.
Print GuardLosesNothing.all_possible.
Print GuardLosesNothing.may_precede.
Print GuardLosesNothing.all_may_precede.
Print GuardLosesNothing.power_up.
Print Shipped.knob.
Print Shipped.microjoules.
Print AcceptedIsValid.valid.
Print AcceptedCovers.device_told.
Print AcceptedCovers.no_worse.
Print AcceptedWindow.joules.
Print AcceptedWindow.si.
Print Hand.moment.
Print Hand.way_in.
Print Hand.motor.
Print Hand.obeys.
Print Hand.along.
Print Hand.speed_after.
Print Hand.put_in.
Print Hand.dissipates.
Print Hand.old_way.
Print Hand.new_way.
Print Hand.kinetic.
Print Hand.is_damped.
Print Hand.time.
Print Hand.is_made_of.
Print Hand.all_made_of.
Print Hand.motion.
Print Hand.inertia_of.
Print Hand.speed_of.
Print LawsArePassive.tdpa_run.
Print LawsArePassive.thesis_sum.
Print LawsArePassive.fba_run.
Print LawsArePassive.port_sum.
Print Mass.mass_tick.
Print Mass.wants.
Print Mass.moves.
Print Mass.augmented.
Print Mass.first_contact.
Print Mass.taken_first.
Print Mass.forgiven.
Print EnhancedIsPassive.valid.
Print EnhancedIsPassive.in_format.
Print EnhancedIsPassive.enhanced_run.
Print EnhancedIsPassive.moves_from.
Print EnhancedIsPassive.taken_from_hand.
Print EnhancedIsPassive.taken_from_mass.
Print EnhancedIsPassive.deficit.
Print EnhancedIsPassive.next_books.
Print EnhancedIsPassive.books_after.
Print EnhancedOffset.step_due.
Print EnhancedOffset.largest_shown.
Print EnhancedOffset.largest_step.
Print EnhancedOffset.stays.
Print EnhancedOffset.steps_due.
Print EnhancedStorage.stretch.
Print EnhancedStorage.storage.
Print EnhancedStorage.ground.
Print EnhancedStorage.leaves_behind.
Print EnhancedStorage.tension.
Print EnhancedStorage.kept_back.
Print EnhancedStorage.residue.
Print EnhancedStorage.dissipated.
Print EnhancedStorage.let_go.
Print EnhancedStorage.fits.
Print EnhancedStorage.has_room.
Print EnhancedStorage.from_mass.
Print EnhancedStorage.over.
Print EnhancedStorage.every.
Print EnhancedStorage.by_tension.
Print EnhancedStorage.by_force.
Print EnhancedStorage.by_kept_back.
Print EnhancedStorage.way.
Print EnhancedStorage.below_limit.
Print Root.digit.
Print Root.digits.
Print Root.level.
Print Root.scaled_16.
Print Root.scaled_32.
Print Root.scaled_64.
Print Root.whole_root.
Print Root.high_root.
Print Root.root_32.
Print Root.root_high_32.
Print Root.root_64.
Print Root.root_high_64.

(** * The claims *)

Check change_of_force.
Check pure_delay_acts_late.
Check current_loop_acts_late.
Check told_change_acts_late.
Check any_window.
Check any_window_by_settings.
Check once_a_tick.
Check read_in_between.
Check knob_acts_late.
Check shipped_window.
Check accepted_is_valid.
Check accepted_covers.
Check no_worse_is_covered.
Check any_accepted_window.
Check hand_balance.
Check drag_damps.
Check hand_gets.
Check any_accepted_hand.
Check thesis_sum_is_never_negative.
Check fba_is_passive.
Check contact_gives_at_most_the_loan.
Check given_at_most.
Check enhanced_gives_at_most_the_loan.
Check enhanced_gives_at_most.
Check enhanced_energy_is_never_negative.
Check offset_in_a_tick.
Check offset_goes_no_further.
Check storage_is_kept.
Check force_is_the_tension_rounded.
Check hand_over_adds_nothing.
Check contact_gives_at_most_what_it_took.
Check quotient_is_div.
Check digits_are_the_root.
Check level_fits.
Check halves_are_the_root.

(** All claims in one term, so that Coq lists their assumptions once. That search goes through everything a term depends on, and
    is slow. *)
Definition claims :=
  (change_of_force, pure_delay_acts_late, current_loop_acts_late, told_change_acts_late, any_window, any_window_by_settings,
   once_a_tick, read_in_between, knob_acts_late, shipped_window, accepted_is_valid, accepted_covers, no_worse_is_covered,
   any_accepted_window, hand_balance, drag_damps, hand_gets, any_accepted_hand, thesis_sum_is_never_negative, fba_is_passive,
   contact_gives_at_most_the_loan, given_at_most, enhanced_gives_at_most_the_loan, enhanced_gives_at_most,
   enhanced_energy_is_never_negative, offset_in_a_tick, offset_goes_no_further, storage_is_kept, force_is_the_tension_rounded,
   hand_over_adds_nothing, contact_gives_at_most_what_it_took, quotient_is_div, digits_are_the_root, level_fits,
   halves_are_the_root).

Print Assumptions claims.
