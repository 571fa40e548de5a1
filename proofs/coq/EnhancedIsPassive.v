(** The enhanced law's whole tick (Enhanced.v) over any number of ticks and any hand: the energy at the virtual mass, and the
    energy that a contact can give.

    Mass.v has the energy balance of the mass for any function that moves it. Here it is shown that the law's ticks have that
    form. *)

Require Import ZArith Lia List Bool Psatz.
From Touchstone Require Import Guard Laws LawsArePassive Mass Enhanced.
Import ListNotations.
Open Scope Z_scope.

(** A value in the range of a signal. *)
Definition a_signal (x : Z) : Prop := lowest_signal <= x <= highest_signal.

(** Inequalities that hold for the coefficients of accepted settings. *)
Record valid (L : enhanced) : Prop := {
  limit_is_a_force : 0 <= limit L <= highest_signal;
  credit_is_stored : 0 <= credit L <= energy_cap;
  inertia_nonneg : 0 <= inertia L;
  coupling_nonneg : 0 <= coupling L;
  mass_damping_nonneg : 0 <= mass_damping L;
  total_holds_all : inertia L + coupling L + mass_damping L <= total L;
  total_positive : 0 < total L;
  series_nonneg : 0 <= series L;
  of_ideal_nonneg : 0 <= of_ideal L;
  of_force_nonneg : 0 <= of_force L;
  of_penetration_nonneg : 0 <= of_penetration L
}.

(** * The memory's invariant *)

(** The invariant after the first contact. *)
Record carried (L : enhanced) (m : state) : Prop := {
  is_augmenting : phase m = Augmenting;
  left_is_stored : 0 <= left m <= energy_cap;
  hip_force_in : 0 <= hip_force m <= limit L;
  at_mass_in : 0 <= at_mass m <= highest_signal;
  mass_in : a_signal (mass m);
  offset_in : 0 <= offset m <= highest_signal
}.

(** The invariant in the first contact. Only inward displacements have been counted, so the energy is at least the loan. *)
Record pressed (L : enhanced) (m : state) : Prop := {
  is_first : phase m = First;
  last_inside : 0 < last m <= highest_signal;
  hip_force_first : 0 <= hip_force m <= limit L;
  loan_is_there : credit L <= left m <= energy_cap;
  no_offset_yet : offset m = 0
}.

Definition sound (L : enhanced) (m : state) : Prop :=
  match phase m with Free => m = free_at (last m) | First => pressed L m | Augmenting => carried L m end.

(** * Numbers *)

Ltac numbers :=
  unfold a_signal, signal, size, within in *;
  change highest_signal with 2147483647 in *; change lowest_signal with (-2147483648) in *;
  change energy_cap with 4611686018427387904 in *; change gain_one with 4096 in *; change signal_one with 16777216 in *; lia.

Lemma signal_is_one (x : Z) : a_signal (signal x).
Proof. numbers. Qed.

Lemma signal_same (x : Z) : a_signal x -> signal x = x.
Proof. numbers. Qed.

Lemma outward_in (t : Z) : 0 <= outward t <= highest_signal.
Proof. unfold outward. assert (0 <= Z.max t 0 / gain_one) by (apply Z.div_pos; [lia | reflexivity]). numbers. Qed.

Lemma outward_up_in (t : Z) : 0 <= outward_up t <= highest_signal.
Proof.
  unfold outward_up. assert (0 <= (Z.max t 0 + gain_one - 1) / gain_one) by (apply Z.div_pos; [numbers | reflexivity]).
  numbers.
Qed.

Lemma share_in (r x : Z) : 0 <= r -> 0 <= x -> 0 <= share r x <= highest_signal.
Proof.
  intros R X. unfold share. assert (0 <= Z.quot (r * x) signal_one) by (apply Z.quot_pos; [nia | reflexivity]). numbers.
Qed.

Lemma share_monotone (r x y : Z) : 0 <= r -> 0 <= x <= y -> share r x <= share r y.
Proof.
  intros R X. unfold share.
  assert (Z.quot (r * x) signal_one <= Z.quot (r * y) signal_one) by (apply Z.quot_le_mono; [reflexivity | nia]).
  numbers.
Qed.

(** The mass moves by exactly the displacement that is counted, because the new position is within the format. *)
Lemma displacement_is_real (L : enhanced) (from drive f : Z) :
  a_signal from -> a_signal (from + displacement L from drive f).
Proof. intros F. unfold displacement, per. set (q := Z.quot _ _). clearbody q. numbers. Qed.

Ltac fields := cbn [phase last hip_force left mass mass_moved offset at_mass moved_on with_left touched free_at].

(** * The mass' ticks are those of Mass.v *)

Lemma affordable_is_paid_move (L : enhanced) (energy place drive wanted : Z) :
  0 <= energy <= energy_cap -> 0 < wanted ->
  affordable_move L energy place drive wanted
  = paid_move (displacement L place drive) (fun retreat => outward_up (drive + total L * retreat)) energy wanted.
Proof.
  intros E W. unfold affordable_move, paid_move.
  destruct (0 <=? energy + wanted * displacement L place drive wanted); [reflexivity|].
  set (retreat := energy / wanted). set (f := Z.min _ wanted).
  assert (R : 0 <= retreat) by (apply Z.div_pos; lia).
  assert (F : 0 <= f) by (unfold f; pose proof (outward_up_in (drive + total L * retreat)); lia).
  destruct (f =? 0) eqn:Z0; [apply Z.eqb_eq in Z0 | apply Z.eqb_neq in Z0].
  - rewrite Z0. reflexivity.
  - assert (N : f <=? 0 = false) by (apply Z.leb_gt; lia). rewrite N. rewrite Z.min_l by nia. reflexivity.
Qed.

(** After [affordable_move] the position of the mass is within the format. *)
Lemma affordable_is_real (L : enhanced) (energy place drive wanted : Z) :
  0 <= energy -> 0 < wanted -> a_signal place ->
  let '(_, _, step) := affordable_move L energy place drive wanted in a_signal (place + step).
Proof.
  intros E W P. unfold affordable_move. pose proof (displacement_is_real L place drive wanted P) as D.
  destruct (0 <=? energy + wanted * displacement L place drive wanted) eqn:A; [exact D|]. apply Z.leb_gt in A.
  destruct (_ =? 0); [apply displacement_is_real; exact P|].
  assert (R0 : 0 <= energy / wanted) by (apply Z.div_pos; lia).
  assert (R1 : wanted * (energy / wanted) <= energy) by (apply Z.mul_div_le; lia).
  set (r := energy / wanted) in *. set (x := displacement L place drive wanted) in *. clearbody r x.
  assert (wanted * (r + x) < 0) by nia. assert (r + x < 0) by nia. unfold a_signal in *. lia.
Qed.

Section Ticks.

Variable L : enhanced.
Hypothesis Valid : valid L.

(** Bounds of energy, force and position after a move of the mass that is coupled to the hand. *)
Lemma move_holds (m : state) (drive wanted : Z) :
  carried L m -> 0 < wanted <= highest_signal ->
  let '(energy, f, step) := move_mass L m drive wanted in
  0 <= energy <= energy_cap /\ 0 <= f <= wanted /\ a_signal (mass m + step).
Proof.
  intros [] W. unfold move_mass. destruct (mass_exact L).
  - pose proof (affordable_is_real L (left m) (mass m) drive wanted ltac:(lia) ltac:(lia) mass_in0) as R.
    rewrite affordable_is_paid_move in * by lia.
    pose proof (books_are_right (displacement L (mass m) drive) (fun r => outward_up (drive + total L * r))
                  (left m) wanted ltac:(lia) ltac:(lia)) as B.
    unfold paid_move in *.
    destruct (0 <=? _); [split; [lia|split; [lia | exact R]]|].
    destruct (_ <=? 0); [split; [lia|split; [lia | exact R]]|]. split; [lia|split; [lia | exact R]].
  - unfold thesis_move. pose proof (thesis_step_holds (left m) wanted (mass_moved m) ltac:(lia) ltac:(lia)) as T.
    assert (C : snd (thesis_step (left m) wanted (mass_moved m)) <= energy_cap) by (unfold thesis_step; cbn; lia).
    destruct (thesis_step (left m) wanted (mass_moved m)) as [f energy]. cbn [snd] in C.
    split; [lia|split; [lia | apply displacement_is_real; exact mass_in0]].
Qed.

Lemma leave_behind_holds (m : state) (energy f wanted : Z) :
  carried L m -> 0 < wanted <= highest_signal -> 0 <= energy <= energy_cap -> 0 <= f <= wanted ->
  let '(energy', f', step) := leave_behind L m energy f wanted in
  0 <= energy' <= energy_cap /\ 0 <= f' <= wanted /\ a_signal (mass m + step).
Proof.
  intros [] W E F. unfold leave_behind. pose proof (displacement_is_real L (mass m) (inertia L * mass_moved m)) as D.
  destruct (mass_exact L).
  - destruct (0 <=? _) eqn:P.
    + apply Z.leb_le in P. assert (0 < energy_cap) by reflexivity. split; [lia|split; [lia | apply D; exact mass_in0]].
    + split; [lia|split; [lia|]]. rewrite Z.add_0_r. exact mass_in0.
  - split; [lia|split; [lia | apply D; exact mass_in0]].
Qed.

(** The memory after a tick in which a contact goes on after its first reversal: the mass moved coupled to the hand, or was left
    behind. *)
Inductive goes_on (m : state) (e moved : Z) : state -> Prop :=
| As_coupled (energy f step shown : Z) :
    move_mass L m (drive_of L m e moved) (wanted_of L m (next_offset L m e)) = (energy, f, step) ->
    shown = coupled L (mass m + step) step e moved -> 0 <= shown -> a_signal (mass m + step) ->
    goes_on m e moved (moved_on m (energy, f, step) e (next_offset L m e) (Z.min shown (limit L)))
| As_left_behind (energy f step energy' f' : Z) :
    move_mass L m (drive_of L m e moved) (wanted_of L m (next_offset L m e)) = (energy, f, step) ->
    a_signal (mass m + step) -> coupled L (mass m + step) step e moved < 0 ->
    forall step', leave_behind L m energy f (wanted_of L m (next_offset L m e)) = (energy', f', step') ->
    a_signal (mass m + step') ->
    goes_on m e moved (moved_on m (energy', f', step') e (next_offset L m e) 0).

Lemma next_offset_in (m : state) (e : Z) : 0 <= offset m <= highest_signal -> 0 <= next_offset L m e <= highest_signal.
Proof. intros O. unfold next_offset. destruct (due L m); [|exact O]. numbers. Qed.

Lemma augmented_goes_on (m : state) (e moved : Z) :
  carried L m ->
  augmented L m e moved = free_at e
  \/ (0 < wanted_of L m (next_offset L m e) /\ goes_on m e moved (augmented L m e moved) /\ carried L (augmented L m e moved)).
Proof.
  intros C. pose proof (next_offset_in m e (offset_in L m C)) as O.
  unfold augmented. set (wanted := wanted_of L m (next_offset L m e)).
  assert (W0 : 0 <= wanted <= highest_signal) by apply outward_in.
  destruct (wanted =? 0) eqn:Z0; [left; reflexivity|]. apply Z.eqb_neq in Z0.
  assert (W : 0 < wanted <= highest_signal) by lia.
  pose proof (move_holds m (drive_of L m e moved) wanted C W) as M.
  destruct (move_mass L m (drive_of L m e moved) wanted) as [[energy f] step] eqn:Mv.
  destruct M as (E & F & R). rewrite (signal_same _ R).
  set (shown := coupled L (mass m + step) step e moved).
  destruct Valid, C.
  destruct ((0 <? shown) || (shown =? 0) && (0 <? e)) eqn:S.
  - right. assert (S0 : 0 <= shown).
    { apply orb_true_iff in S. destruct S as [S|S]; [apply Z.ltb_lt in S; lia|].
      apply andb_true_iff in S. destruct S as [S _]. apply Z.eqb_eq in S. lia. }
    split; [lia|split].
    + apply As_coupled; [exact Mv | reflexivity | exact S0 | exact R].
    + constructor; fields; try lia; [reflexivity | apply signal_is_one].
  - destruct (e <=? 0) eqn:Out; [left; reflexivity|]. right. apply Z.leb_gt in Out.
    assert (S0 : shown < 0).
    { apply orb_false_iff in S. destruct S as [S1 S2]. apply Z.ltb_ge in S1.
      rewrite (proj2 (Z.ltb_lt 0 e) Out), andb_true_r in S2. apply Z.eqb_neq in S2. lia. }
    pose proof (leave_behind_holds m energy f wanted ltac:(constructor; assumption) W E F) as B.
    destruct (leave_behind L m energy f wanted) as [[energy' f'] step'] eqn:Lb. destruct B as (E' & F' & R').
    rewrite (Z.min_l 0) by lia.
    split; [lia|split].
    + apply (As_left_behind m e moved energy f step energy' f' Mv R S0 step' Lb R').
    + constructor; fields; try lia; [reflexivity | apply signal_is_one].
Qed.

(** With the exact observer such a tick is a [mass_tick] of Mass.v with the mass' real displacement. *)
Lemma a_tick_of_the_books (m : state) (e moved : Z) (m' : state) :
  mass_exact L = true -> carried L m -> 0 < wanted_of L m (next_offset L m e) -> goes_on m e moved m' ->
  exists t : mass_tick, 0 < wants t /\ moves (left m) t = (left m', at_mass m', mass m' - mass m).
Proof.
  intros Ex C W G. destruct C. destruct G as [energy f step shown Mv _ _ R | energy f step energy' f' Mv _ _ step' Lb R].
  - exists (Coupled (displacement L (mass m) (drive_of L m e moved))
              (fun r => outward_up (drive_of L m e moved + total L * r)) (wanted_of L m (next_offset L m e))).
    split; [exact W|]. unfold move_mass in Mv. rewrite Ex in Mv. cbn [moves].
    rewrite <- affordable_is_paid_move by assumption. rewrite Mv. cbn. rewrite (signal_same _ R). f_equal. lia.
  - exists (LeftBehind (displacement L (mass m) (inertia L * mass_moved m)) (wanted_of L m (next_offset L m e))).
    split; [exact W|]. cbn [moves]. unfold leave_behind in Lb. rewrite Ex in Lb. unfold coast.
    cbn [moved_on left at_mass mass]. rewrite (signal_same _ R). rewrite Lb. f_equal. lia.
Qed.

Lemma stored_nonneg (stretch : Z) : 0 <= stretch -> 0 <= stored L stretch.
Proof.
  intros S. unfold stored. pose proof (outward_up_in (coupling L * stretch)). apply Z.div_pos; [nia | reflexivity].
Qed.

(** After [hand_over] the invariant holds, and the energy is at most the energy before, or 0 if that was negative. *)
Lemma hand_over_holds (m : state) :
  0 < last m <= highest_signal -> 0 <= hip_force m <= limit L -> left m <= energy_cap ->
  let m' := hand_over L m in carried L m' /\ left m' <= Z.max (left m) 0.
Proof.
  intros Hl Hf He. unfold hand_over.
  set (place := if keep_force L then _ else _). set (off := if keep_force L then _ else 0).
  set (stretch := size (signal (last m - place))).
  assert (St : 0 <= stored L stretch) by (apply stored_nonneg; unfold stretch, size; lia || numbers).
  assert (P : a_signal place).
  { unfold place. destruct (keep_force L); [apply signal_is_one|]. unfold per. set (q := Z.quot _ _). clearbody q. numbers. }
  assert (O : 0 <= off <= highest_signal).
  { unfold off. destruct (keep_force L); [|numbers]. set (x := _ - place). clearbody x. numbers. }
  assert (C : 0 < energy_cap) by reflexivity.
  destruct (_ && (stored L stretch <=? left m)) eqn:Cov.
  - apply andb_true_iff in Cov. destruct Cov as [_ Cov]. apply Z.leb_le in Cov.
    split; [constructor; fields; try lia; try reflexivity; [apply outward_in | exact P] | fields; lia].
  - assert (P' : a_signal (last m)) by numbers.
    split; [constructor; fields; try lia; try reflexivity; [apply outward_in | exact P'] | fields; lia].
Qed.

Lemma free_is_sound (e : Z) : sound L (free_at e).
Proof. reflexivity. Qed.

Lemma carried_is_sound (m : state) : carried L m -> sound L m.
Proof. intros C. unfold sound. rewrite (is_augmenting L m C). exact C. Qed.

(** Every tick keeps the invariant, for any penetration in the format and any displacement. *)
Lemma tick_is_sound (m : state) (e moved : Z) : a_signal e -> sound L m -> sound L (enhanced_tick L m e moved).
Proof.
  intros Se S. unfold sound in S. unfold enhanced_tick. destruct (phase m) eqn:Ph.
  - destruct (0 <? e) eqn:In; [|reflexivity]. apply Z.ltb_lt in In. destruct Valid.
    unfold sound. cbn. pose proof (outward_in (desired L * e)).
    constructor; fields; try reflexivity; numbers.
  - destruct S. set (w := with_left m (booked_first m moved)).
    destruct (turns e moved) eqn:T.
    + destruct (hand_over_holds w) as [C _]; [exact last_inside0 | exact hip_force_first0 | unfold w, booked_first; fields; lia|].
      destruct (augmented_goes_on (hand_over L w) e moved C) as [->|(_ & _ & K)]; [reflexivity|].
      apply carried_is_sound. exact K.
    + destruct (0 <? e) eqn:In; [|reflexivity]. apply Z.ltb_lt in In.
      assert (M : 0 <= moved).
      { unfold turns in T. assert (I : 0 <? e = true) by (apply Z.ltb_lt; exact In). rewrite I, andb_true_r in T.
        apply Z.ltb_ge in T. exact T. }
      destruct Valid. unfold sound. cbn. unfold w, booked_first. pose proof (outward_in (desired L * e)).
      assert (0 <= hip_force m * moved) by nia.
      constructor; fields; try assumption; try reflexivity; numbers.
  - destruct (augmented_goes_on m e moved S) as [->|(_ & _ & K)]; [reflexivity|]. apply carried_is_sound. exact K.
Qed.

End Ticks.

(** * Any number of ticks *)

(** Penetration and displacement of each tick; the displacement need not be the difference of penetrations. *)
Definition hand : Set := list (Z * Z).

(** Each penetration is in the range of a signal. The displacements are arbitrary. *)
Definition in_format (h : hand) : Prop := Forall (fun it => a_signal (fst it)) h.

Fixpoint enhanced_run (L : enhanced) (m : state) (h : hand) : state :=
  match h with [] => m | (e, moved) :: h => enhanced_run L (enhanced_tick L m e moved) h end.

Lemma run_is_sound (L : enhanced) (m : state) (h : hand) : valid L -> in_format h -> sound L m -> sound L (enhanced_run L m h).
Proof.
  intros V. revert m. induction h as [|[e moved] h IH]; intros m F S; cbn [enhanced_run]; [exact S|].
  inversion F; subst. apply IH; [assumption|]. apply tick_is_sound; assumption.
Qed.

(** * The energy at the mass *)

(** The memory from which the mass moves in a tick. If the first contact ends in this tick, it is the memory after [hand_over]. *)
Definition moves_from (L : enhanced) (m : state) (moved : Z) : state :=
  match phase m with First => hand_over L (with_left m (booked_first m moved)) | _ => m end.

(** The energy that the wall takes in a tick. In the first contact it comes from the hand: last force times displacement. Later it
    comes from the mass: the force on the mass times its real displacement. *)
Definition taken_from_hand (m : state) (moved : Z) : Z := match phase m with First => hip_force m * moved | _ => 0 end.
Definition taken_from_mass (L : enhanced) (m : state) (e moved : Z) : Z :=
  let m' := enhanced_tick L m e moved in
  match phase m' with Augmenting => at_mass m' * (mass m' - mass (moves_from L m moved)) | _ => 0 end.

(** The size of a negative energy with which the first contact ends; the law forgives this deficit. *)
Definition deficit (m : state) (moved : Z) : Z := match phase m with First => Z.max 0 (- booked_first m moved) | _ => 0 end.

(** Energy sums of a contact: taken by the wall, forgiven, and given in the tick that ended the first contact. *)
Record books : Set := { took : Z; forgave : Z; at_turn : Z }.
Definition no_books : books := {| took := 0; forgave := 0; at_turn := 0 |}.

(** The sums after a tick. They are 0 at the beginning of a contact. *)
Definition next_books (L : enhanced) (m : state) (b : books) (e moved : Z) : books :=
  match phase m with
  | Free => no_books
  | First => {| took := took b + taken_from_hand m moved + taken_from_mass L m e moved;
                forgave := forgave b + deficit m moved;
                at_turn := Z.max 0 (- (hip_force m * moved)) |}
  | Augmenting => {| took := took b + taken_from_mass L m e moved; forgave := forgave b; at_turn := at_turn b |}
  end.

Fixpoint books_after (L : enhanced) (m : state) (b : books) (h : hand) : books :=
  match h with [] => b | (e, moved) :: h => books_after L (enhanced_tick L m e moved) (next_books L m b e moved) h end.

Definition balanced (L : enhanced) (m : state) (b : books) : Prop :=
  0 <= left m <= credit L + took b + forgave b
  /\ 0 <= forgave b <= Z.max 0 (at_turn b - credit L)
  /\ (phase m = First -> forgave b = 0 /\ at_turn b = 0).

(** In a tick after the first contact the energy grows by at most what the wall takes from the mass. *)
Lemma mass_is_paid (L : enhanced) (m : state) (e moved : Z) :
  valid L -> mass_exact L = true -> carried L m ->
  let m' := augmented L m e moved in
  m' = free_at e \/ (carried L m' /\ left m' <= left m + at_mass m' * (mass m' - mass m)).
Proof.
  intros V Ex C. destruct (augmented_goes_on L V m e moved C) as [E|(W & G & K)]; [left; exact E | right].
  split; [exact K|]. destruct (a_tick_of_the_books L m e moved _ Ex C W G) as (t & T & M).
  pose proof (left_is_stored L m C) as [E0 _].
  destruct t as [disp force_for w | disp w]; cbn [moves wants] in *.
  - pose proof (books_are_right disp force_for (left m) w E0 T) as P. rewrite M in P. lia.
  - pose proof (coast_is_paid disp (left m) w E0) as P. rewrite M in P. lia.
Qed.

Lemma tick_is_balanced (L : enhanced) (m : state) (b : books) (e moved : Z) :
  valid L -> mass_exact L = true -> sound L m -> balanced L m b -> a_signal e ->
  balanced L (enhanced_tick L m e moved) (next_books L m b e moved).
Proof.
  intros V Ex S (B1 & B2 & B3) Se. destruct (credit_is_stored L V) as [C0 C1].
  unfold next_books, taken_from_mass, moves_from, taken_from_hand, deficit, sound in *.
  unfold enhanced_tick in *. destruct (phase m) eqn:Ph.
  - unfold balanced, no_books. destruct (0 <? e); cbn [took forgave at_turn]; fields; (split; [lia|split; [lia|]]); intros; lia.
  - destruct S. destruct (B3 eq_refl) as [F0 T0]. set (w := with_left m (booked_first m moved)).
    assert (Wl : left w = booked_first m moved) by reflexivity.
    assert (Bk : booked_first m moved <= left m + hip_force m * moved) by (unfold booked_first; lia).
    assert (Bc : left m + hip_force m * moved <= energy_cap -> booked_first m moved = left m + hip_force m * moved)
      by (unfold booked_first; lia).
    assert (Dt : Z.max 0 (- booked_first m moved) <= Z.max 0 (Z.max 0 (- (hip_force m * moved)) - credit L)) by (unfold booked_first; lia).
    destruct (turns e moved) eqn:T.
    + destruct (hand_over_holds L w) as [Cw Lw]; [exact last_inside0 | exact hip_force_first0 | rewrite Wl; unfold booked_first; lia|].
      destruct (mass_is_paid L (hand_over L w) e moved V Ex Cw) as [E|(K & P)].
      * rewrite E. unfold balanced. cbn [took forgave at_turn phase free_at left]. split; [lia|split; [lia|discriminate]].
      * rewrite (is_augmenting L _ K). unfold balanced. cbn [took forgave at_turn].
        rewrite (is_augmenting L _ K). pose proof (left_is_stored L _ K). rewrite Wl in Lw.
        split; [lia|split; [lia|discriminate]].
    + destruct (0 <? e) eqn:In; unfold balanced; cbn [took forgave at_turn]; fields.
      * assert (M : 0 <= moved).
        { unfold turns in T. rewrite In, andb_true_r in T. apply Z.ltb_ge in T. exact T. }
        assert (0 <= hip_force m * moved) by nia. fold w. rewrite Wl.
        split; [unfold booked_first in *; lia|split; [lia|]]. intros _. unfold booked_first in *. lia.
      * split; [lia|split; [lia|discriminate]].
  - destruct (mass_is_paid L m e moved V Ex S) as [E|(K & P)].
    + rewrite E. unfold balanced. cbn [took forgave at_turn phase free_at left]. split; [lia|split; [lia|discriminate]].
    + rewrite (is_augmenting L _ K). unfold balanced. cbn [took forgave at_turn].
      rewrite (is_augmenting L _ K). pose proof (left_is_stored L _ K). split; [lia|split; [lia|discriminate]].
Qed.

(** At every tick of every contact, whatever the hand does, the energy is not negative. What the wall has given in this contact,
    to the hand before its first reversal and to the mass after it, is at most the loan and the forgiven deficit. *)
Theorem enhanced_gives_at_most_the_loan (L : enhanced) (e0 : Z) (h : hand) :
  valid L -> mass_exact L = true -> in_format h ->
  let m := enhanced_run L (free_at e0) h in
  let b := books_after L (free_at e0) no_books h in
  0 <= left m <= credit L + took b + forgave b /\ 0 <= forgave b <= Z.max 0 (at_turn b - credit L).
Proof.
  intros V Ex F m b.
  enough (G : forall m b, sound L m -> balanced L m b -> balanced L (enhanced_run L m h) (books_after L m b h)).
  { destruct (G (free_at e0) no_books) as (B1 & B2 & _); [reflexivity | | split; [exact B1 | exact B2]].
    destruct (credit_is_stored L V). unfold balanced, no_books. cbn. split; [lia|split; [lia|discriminate]]. }
  clear m b. induction h as [|[e moved] h IH]; intros m b S B; cbn [enhanced_run books_after]; [exact B|].
  inversion F; subst. apply IH; [assumption | apply tick_is_sound; assumption | apply tick_is_balanced; assumption].
Qed.

(** So a contact gives at most the larger of the loan and the energy given in the tick that ended its first contact. *)
Theorem enhanced_gives_at_most (L : enhanced) (e0 : Z) (h : hand) :
  valid L -> mass_exact L = true -> in_format h ->
  let b := books_after L (free_at e0) no_books h in
  - took b <= Z.max (credit L) (at_turn b).
Proof. intros V Ex F b. destruct (enhanced_gives_at_most_the_loan L e0 h V Ex F). unfold b. lia. Qed.

(** With either observer the law's energy is never negative. *)
Theorem enhanced_energy_is_never_negative (L : enhanced) (e0 : Z) (h : hand) :
  valid L -> in_format h -> 0 <= left (enhanced_run L (free_at e0) h) <= energy_cap.
Proof.
  intros V F. pose proof (run_is_sound L (free_at e0) h V F eq_refl) as S. unfold sound in S.
  set (m := enhanced_run L (free_at e0) h) in *. destruct (phase m) eqn:Ph.
  - rewrite S. cbn [left free_at]. assert (0 < energy_cap) by reflexivity. lia.
  - destruct S, (credit_is_stored L V). lia.
  - apply (left_is_stored L m S).
Qed.
