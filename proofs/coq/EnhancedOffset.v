(** The offset of the enhanced law (thesis Algorithm 3.1, lines 7 to 13) over any number of ticks. It is never negative, no step
    is larger than any of its three bounds, and over many ticks the offset changes by at most the sum of these steps. *)

Require Import ZArith Lia List Bool Psatz.
From Touchstone Require Import Guard Laws Enhanced EnhancedIsPassive.
Import ListNotations.
Open Scope Z_scope.

(** The largest change of the offset in a tick; zero if the law does not change the offset in this tick. *)
Definition step_due (L : enhanced) (m : state) (e : Z) : Z := if due L m then offset_step L m e else 0.

(** The largest force at the point (HIP or mass) where the stiffness is regulated. *)
Definition largest_shown (L : enhanced) : Z := if at_hip L then limit L else highest_signal.

(** The largest step that the settings allow: its bound by the force (3.9) for the largest force, or its bound by the penetration
    (3.11) for the largest position of the format. *)
Definition largest_step (L : enhanced) : Z :=
  Z.min (Z.max (share (of_force L) (Z.max (largest_shown L) 1)) 1) (share (of_penetration L) highest_signal).

(** The regulated force is between zero and the largest force. *)
Lemma shown_in (L : enhanced) (m : state) : valid L -> carried L m -> 0 <= regulated L m <= largest_shown L.
Proof. intros V []. unfold regulated, largest_shown. destruct (at_hip L); lia. Qed.

Lemma step_in (L : enhanced) (m : state) (e : Z) :
  valid L -> carried L m ->
  0 <= step_due L m e <= largest_step L
  /\ step_due L m e <= ideal L m e /\ step_due L m e <= weber L m /\ step_due L m e <= near L m e.
Proof.
  intros V C. pose proof (shown_in L m V C) as Sh. destruct V as [? ? ? ? ? ? ? ? Hi Hf Hp].
  assert (Sz : forall x, 0 <= size x <= highest_signal) by (intros x; numbers).
  assert (I : 0 <= ideal L m e) by (apply share_in; [assumption | apply Sz]).
  assert (W : 1 <= weber L m) by (unfold weber; lia).
  assert (N : 0 <= near L m e) by (apply share_in; [assumption | apply Sz]).
  assert (Wl : weber L m <= Z.max (share (of_force L) (Z.max (largest_shown L) 1)) 1).
  { unfold weber.
    pose proof (share_monotone (of_force L) (Z.max (regulated L m) 1) (Z.max (largest_shown L) 1) Hf). lia. }
  assert (Nl : near L m e <= share (of_penetration L) highest_signal) by (apply share_monotone; [assumption | apply Sz]).
  unfold step_due, offset_step, largest_step in *. destruct (due L m); lia.
Qed.

Lemma offset_moves (L : enhanced) (m : state) (e : Z) :
  valid L -> carried L m ->
  Z.abs (next_offset L m e - offset m) <= step_due L m e
  /\ (regulated L m < regulated_to L m e -> offset m <= next_offset L m e)
  /\ (regulated_to L m e <= regulated L m -> next_offset L m e <= offset m).
Proof.
  intros V C. pose proof (step_in L m e V C) as [S _]. pose proof (offset_in L m C) as O.
  unfold next_offset, step_due in *. destruct (due L m); [|lia].
  destruct (regulated L m <? regulated_to L m e) eqn:R; [apply Z.ltb_lt in R | apply Z.ltb_ge in R];
    set (d := offset_step L m e) in *; clearbody d; numbers.
Qed.

(** One tick of a contact after its first reversal of motion. The offset is not negative. It changes by at most each of the three
    bounds, only in ticks in which the law changes it, and in the direction that brings the force to the wanted force. *)
Theorem offset_in_a_tick (L : enhanced) (e0 : Z) (before : hand) (e moved : Z) :
  valid L -> in_format before -> a_signal e ->
  let m := enhanced_run L (free_at e0) before in
  let m' := enhanced_tick L m e moved in
  phase m = Augmenting -> phase m' = Augmenting ->
  let change := offset m' - offset m in
  0 <= offset m'
  /\ Z.abs change <= ideal L m e /\ Z.abs change <= weber L m /\ Z.abs change <= near L m e
  /\ (due L m = false -> change = 0)
  /\ (regulated L m < regulated_to L m e -> 0 <= change) /\ (regulated_to L m e <= regulated L m -> change <= 0).
Proof.
  intros V F Se m m' Ph Ph' change.
  pose proof (run_is_sound L (free_at e0) before V F eq_refl) as C. fold m in C. unfold sound in C. rewrite Ph in C.
  assert (O : offset m' = next_offset L m e).
  { unfold m', enhanced_tick in *. rewrite Ph in *. destruct (augmented_goes_on L V m e moved C) as [E|(_ & G & _)].
    - rewrite E in Ph'. discriminate.
    - destruct G; reflexivity. }
  pose proof (step_in L m e V C) as [S0 S]. pose proof (offset_moves L m e V C) as M.
  pose proof (next_offset_in L m e (offset_in L m C)) as In. unfold change. rewrite O.
  repeat split; try lia. intros D. unfold step_due in M, S0. rewrite D in M. lia.
Qed.

(** A window of ticks after the first reversal, in one contact. *)
Fixpoint stays (L : enhanced) (m : state) (h : hand) : Prop :=
  match h with
  | [] => phase m = Augmenting
  | (e, moved) :: h => phase m = Augmenting /\ stays L (enhanced_tick L m e moved) h
  end.

(** The sum of the largest steps of the window's ticks, each the least of its three bounds. *)
Fixpoint steps_due (L : enhanced) (m : state) (h : hand) : Z :=
  match h with [] => 0 | (e, moved) :: h => step_due L m e + steps_due L (enhanced_tick L m e moved) h end.

Lemma stays_now (L : enhanced) (m : state) (h : hand) : stays L m h -> phase m = Augmenting.
Proof. destruct h as [|[e moved] h]; cbn [stays]; tauto. Qed.

Lemma offset_goes_from (L : enhanced) (m : state) (h : hand) :
  valid L -> sound L m -> in_format h -> stays L m h ->
  Z.abs (offset (enhanced_run L m h) - offset m) <= steps_due L m h <= Z.of_nat (length h) * largest_step L.
Proof.
  intros V. revert m. induction h as [|[e moved] h IH]; intros m S F St; cbn [enhanced_run steps_due length]; [lia|].
  inversion F; subst. destruct St as [Ph St]. cbn [fst] in *.
  assert (C : carried L m) by (unfold sound in S; rewrite Ph in S; exact S).
  pose proof (tick_is_sound L V m e moved H1 S) as S'.
  assert (O : offset (enhanced_tick L m e moved) = next_offset L m e).
  { pose proof (stays_now _ _ _ St) as Ph'. unfold enhanced_tick in *. rewrite Ph in *.
    destruct (augmented_goes_on L V m e moved C) as [E|(_ & G & _)]; [rewrite E in Ph'; discriminate | destruct G; reflexivity]. }
  specialize (IH _ S' H2 St). pose proof (offset_moves L m e V C) as [M _]. pose proof (step_in L m e V C) as [B _].
  set (tail := steps_due L (enhanced_tick L m e moved) h) in *. clearbody tail. rewrite Nat2Z.inj_succ. nia.
Qed.

(** Whatever happened before the window and whatever the hand does, the offset is not negative after the window. If the window is
    in one contact after its first reversal, the offset changes by at most the sum of the steps. That sum is at most the number of
    ticks times the largest step that the settings allow. *)
Theorem offset_goes_no_further (L : enhanced) (e0 : Z) (before window : hand) :
  valid L -> in_format before -> in_format window ->
  let m := enhanced_run L (free_at e0) before in
  let m' := enhanced_run L m window in
  0 <= offset m' <= highest_signal
  /\ (stays L m window ->
      Z.abs (offset m' - offset m) <= steps_due L m window <= Z.of_nat (length window) * largest_step L).
Proof.
  intros V Fb Fw m m'. pose proof (run_is_sound L (free_at e0) before V Fb eq_refl) as S. fold m in S.
  split; [|intros St; apply offset_goes_from; assumption].
  pose proof (run_is_sound L m window V Fw S) as S'. fold m' in S'. unfold sound in S'.
  destruct (phase m').
  - rewrite S'. cbn [offset free_at]. numbers.
  - rewrite (no_offset_yet L m' S'). numbers.
  - apply (offset_in L m' S').
Qed.
