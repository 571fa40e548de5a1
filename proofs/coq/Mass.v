(** The virtual mass of the enhanced law (control/src/law/enhanced.rs): its energy over a whole contact, with the loan and the
    forgiven deficit. The mass' displacement under a force, and the force for a retreat, may be any functions; the theorems do not
    depend on them. *)

Require Import ZArith Lia List Psatz.
From Touchstone Require Import Laws.
Import ListNotations.
Open Scope Z_scope.

(** [EnhancedSfa::affordable_move]. The results are energy, force and displacement of the mass. *)
Definition paid_move (displacement force_for : Z -> Z) (energy wanted : Z) : Z * Z * Z :=
  let step := displacement wanted in
  let after := energy + wanted * step in
  if 0 <=? after then (Z.min after energy_cap, wanted, step)
  else
    let retreat := energy / wanted in
    let force := Z.min (force_for retreat) wanted in
    if force <=? 0 then (energy, 0, displacement 0)
    else (Z.min (energy - force * retreat) energy_cap, force, - retreat).

(** [EnhancedSfa::leave_behind]: the mass moves on without the coupling if its energy covers the move, and otherwise stands
    still. *)
Definition coast (displacement : Z -> Z) (energy wanted : Z) : Z * Z * Z :=
  let step := displacement wanted in
  let after := energy + wanted * step in
  if 0 <=? after then (Z.min after energy_cap, wanted, step) else (energy, wanted, 0).

Lemma books_are_right (displacement force_for : Z -> Z) (energy wanted : Z) :
  0 <= energy -> 0 < wanted ->
  let '(energy', force, moved) := paid_move displacement force_for energy wanted in
  0 <= energy' <= energy + force * moved /\ 0 <= force <= wanted.
Proof.
  intros E W. unfold paid_move. assert (C : 0 < energy_cap) by reflexivity.
  destruct (0 <=? energy + wanted * displacement wanted) eqn:P.
  - apply Z.leb_le in P. lia.
  - set (retreat := energy / wanted). set (force := Z.min (force_for retreat) wanted).
    assert (R0 : 0 <= retreat) by (apply Z.div_pos; lia).
    assert (R1 : wanted * retreat <= energy) by (apply Z.mul_div_le; lia).
    destruct (force <=? 0) eqn:F; [lia|]. apply Z.leb_gt in F.
    assert (force <= wanted) by (unfold force; lia). clearbody force retreat. nia.
Qed.

Lemma coast_is_paid (displacement : Z -> Z) (energy wanted : Z) :
  0 <= energy ->
  let '(energy', force, moved) := coast displacement energy wanted in
  0 <= energy' <= energy + force * moved /\ force = wanted.
Proof.
  intros E. unfold coast. assert (C : 0 < energy_cap) by reflexivity.
  destruct (0 <=? energy + wanted * displacement wanted) eqn:P; [apply Z.leb_le in P|]; lia.
Qed.

(** A tick after the first contact. The mass is coupled to the hand, or left behind (uncoupled, because the coupling would
    pull). *)
Inductive mass_tick : Set :=
| Coupled (displacement force_for : Z -> Z) (wanted : Z)
| LeftBehind (displacement : Z -> Z) (wanted : Z).

Definition wants (t : mass_tick) : Z := match t with Coupled _ _ w => w | LeftBehind _ w => w end.

Definition moves (energy : Z) (t : mass_tick) : Z * Z * Z :=
  match t with
  | Coupled displacement force_for wanted => paid_move displacement force_for energy wanted
  | LeftBehind displacement wanted => coast displacement energy wanted
  end.

(** Energy left, and energy that the wall took from the mass, after the ticks [ts]. *)
Fixpoint augmented (energy : Z) (ts : list mass_tick) (took : Z) : Z * Z :=
  match ts with
  | [] => (energy, took)
  | t :: ts => let '(energy', force, moved) := moves energy t in augmented energy' ts (took + force * moved)
  end.

(** The energy after the first contact, from force and displacement of each of its ticks, up to the tick that turns outward. *)
Fixpoint first_contact (energy : Z) (ticks : list (Z * Z)) : Z :=
  match ticks with
  | [] => energy
  | (force, moved) :: ticks => first_contact (Z.min (energy + force * moved) energy_cap) ticks
  end.

Fixpoint taken_first (ticks : list (Z * Z)) : Z :=
  match ticks with [] => 0 | (force, moved) :: ticks => force * moved + taken_first ticks end.

(** [EnhancedSfa::hand_over]: takes off the energy [stored] in the coupling if the energy covers it. Otherwise nothing is taken
    off, and a negative energy is forgiven: it becomes 0. *)
Definition hand_over (energy stored : Z) : Z :=
  if 0 <=? energy - stored then energy - stored else Z.max energy 0.

(** The most energy that is forgiven. Only the tick that turned outward can make the energy negative, at most by that tick's
    work. *)
Definition forgiven (force moved : Z) : Z := Z.max 0 (- (force * moved)).

(** A contact has inward ticks, the tick that turns outward, and any number of ticks of the mass. Its energy is never negative.
    The wall gives in all at most the loan and the forgiven deficit; its work counts over the hand's displacements first, then
    over the mass'. *)
Theorem contact_gives_at_most_the_loan
  (credit : Z) (inward : list (Z * Z)) (force moved stored : Z) (ts : list mass_tick) :
  0 <= credit <= energy_cap ->
  Forall (fun it => 0 <= fst it /\ 0 <= snd it) inward ->
  0 <= force -> 0 <= stored ->
  Forall (fun t => 0 < wants t) ts ->
  let at_turn := first_contact credit (inward ++ [(force, moved)]) in
  let '(energy, took) := augmented (hand_over at_turn stored) ts 0 in
  0 <= energy <= credit + taken_first (inward ++ [(force, moved)]) + forgiven force moved + took.
Proof.
  intros C In F St Ts at_turn.
  assert (Turn : forall inward energy, 0 <= energy <= energy_cap ->
            Forall (fun it => 0 <= fst it /\ 0 <= snd it) inward ->
            let e := first_contact energy (inward ++ [(force, moved)]) in
            e <= energy + taken_first (inward ++ [(force, moved)]) /\ - forgiven force moved <= e).
  { clear at_turn In inward. induction inward as [|[f x] inward IH]; intros energy E In.
    - cbn. unfold forgiven, energy_cap. lia.
    - inversion In as [|? ? [F0 X0] In']; subst. cbn [fst snd] in *.
      assert (0 <= f * x) by (apply Z.mul_nonneg_nonneg; assumption).
      assert (B : 0 <= Z.min (energy + f * x) energy_cap <= energy_cap) by lia.
      specialize (IH _ B In'). cbn [app first_contact taken_first] in *. lia. }
  destruct (Turn inward credit C In) as [T1 T2]. fold at_turn in T1, T2.
  set (sum := taken_first (inward ++ [(force, moved)])) in *.
  assert (H : 0 <= hand_over at_turn stored <= credit + sum + forgiven force moved + 0).
  { unfold hand_over. assert (0 <= forgiven force moved) by (unfold forgiven; lia).
    destruct (0 <=? at_turn - stored) eqn:P; [apply Z.leb_le in P|]; lia. }
  enough (G : forall took energy, 0 <= energy <= credit + sum + forgiven force moved + took ->
            let '(energy, took) := augmented energy ts took in
            0 <= energy <= credit + sum + forgiven force moved + took) by (apply G; exact H).
  clear H. induction ts as [|t ts IH]; intros took energy H; cbn [augmented]; [exact H|].
  inversion Ts as [|? ? W Ts']; subst.
  assert (M : let '(energy', f, x) := moves energy t in 0 <= energy' <= energy + f * x).
  { destruct t as [disp force_for w | disp w]; cbn [moves wants] in *.
    - pose proof (books_are_right disp force_for energy w (proj1 H) W) as P.
      destruct (paid_move disp force_for energy w) as [[a b] x]. tauto.
    - pose proof (coast_is_paid disp energy w (proj1 H)) as P.
      destruct (coast disp energy w) as [[a b] x]. tauto. }
  destruct (moves energy t) as [[energy' f] x]. apply IH; [exact Ts' | lia].
Qed.

(** The second part alone: the wall gives at most the loan and the forgiven deficit. *)
Corollary given_at_most (credit : Z) (inward : list (Z * Z)) (force moved stored : Z) (ts : list mass_tick) :
  0 <= credit <= energy_cap ->
  Forall (fun it => 0 <= fst it /\ 0 <= snd it) inward ->
  0 <= force -> 0 <= stored ->
  Forall (fun t => 0 < wants t) ts ->
  let ticks := inward ++ [(force, moved)] in
  let '(_, took) := augmented (hand_over (first_contact credit ticks) stored) ts 0 in
  - (taken_first ticks + took) <= credit + forgiven force moved.
Proof.
  intros C In F St Ts. cbn zeta.
  pose proof (contact_gives_at_most_the_loan credit inward force moved stored ts C In F St Ts) as P. cbn zeta in P.
  destruct (augmented _ ts 0) as [energy took]. lia.
Qed.
