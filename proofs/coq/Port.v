(** The port between hand and device, between two samples: the energy that a force takes from the hand over a displacement, and
    the least energy that a damper dissipates meanwhile.

    Positions, fractions of a tick and energies are rational numbers, in quanta (smallest steps of the number format). They come
    as near as one likes to any position that a hand can choose, and every statement here is about sums and products. *)

Require Import QArith Qabs Lqa List.
Open Scope Q_scope.

(** A part of a tick; [share] is its length in ticks. In it the device moves by [moved], and a damping of [c] over a whole tick
    dissipates [damped]. That is at least [c moved^2 / share] for every motion within the part (Cauchy and Schwarz). In a part of
    length zero nothing moves. *)
Record part_of_tick (c share moved damped : Q) : Prop := {
  damps : 0 <= damped;
  damps_enough : c * (moved * moved) <= share * damped;
  takes_time : share == 0 -> moved == 0
}.

Lemma square_nonneg (x : Q) : 0 <= x * x.
Proof. nra. Qed.

Lemma times_nonneg (a b : Q) : 0 <= a -> 0 <= b -> 0 <= a * b.
Proof. nra. Qed.

Lemma scaled (a x y : Q) : 0 <= a -> x <= y -> a * x <= a * y.
Proof. intros Ha H. assert (0 <= a * (y - x)) by (apply times_nonneg; lra). lra. Qed.

Lemma cancel (a x y : Q) : 0 < a -> a * x <= a * y -> x <= y.
Proof. intros Ha H. destruct (Qlt_le_dec y x) as [L|L]; [nra | exact L]. Qed.

(** (1) of docs/energy-guard.md: the two parts of a tick together. [g] is the change of force between them, [s] the length of
    the first part in ticks. A hand can get energy by dividing the displacement otherwise than by [s]; [kappa g^2] covers this
    energy. *)
Theorem change_of_force (c s kappa early rest d1 d2 g : Q) :
  0 <= s <= 1 -> 0 <= c -> 0 <= kappa -> s * (1 - s) <= 4 * c * kappa ->
  part_of_tick c s early d1 -> part_of_tick c (1 - s) rest d2 ->
  c * ((early + rest) * (early + rest)) - s * g * (early + rest) - kappa * (g * g)
  <= d1 + d2 - g * early.
Proof.
  intros [Hs0 Hs1] Hc Hk Hp [A1 B1 C1] [A2 B2 C2].
  set (x := early + rest).
  set (z := (1 - s) * early - s * rest).
  set (p := s * (1 - s)) in *.
  set (V := d1 + d2 - c * (x * x)).
  assert (Ez : early == s * x + z) by (unfold x, z; ring).
  assert (Hpp : 0 <= p) by (apply times_nonneg; lra).
  (* p V >= c z^2 *)
  assert (HV : c * (z * z) <= p * V).
  { assert (H1 : (1 - s) * (c * (early * early)) <= (1 - s) * (s * d1)) by nra.
    assert (H2 : s * (c * (rest * rest)) <= s * ((1 - s) * d2)) by nra.
    assert (E1 : p * V == (1 - s) * (s * d1) + s * ((1 - s) * d2) - c * (p * (x * x))) by (unfold V, p; ring).
    assert (E2 : c * (z * z) == (1 - s) * (c * (early * early)) + s * (c * (rest * rest)) - c * (p * (x * x)))
      by (unfold z, p, x; ring).
    lra. }
  assert (Goal' : 0 <= V - g * z + kappa * (g * g)).
  { destruct (Qlt_le_dec 0 p) as [P|P].
    - assert (Hcp : 0 < c). { destruct (Qlt_le_dec 0 c) as [L|L]; [exact L | nra]. }
      assert (Hkp : 0 < kappa). { destruct (Qlt_le_dec 0 kappa) as [L|L]; [exact L | nra]. }
      assert (V0 : 0 <= V). { apply (cancel p); [exact P|]. assert (0 <= c * (z * z)) by nra. lra. }
      assert (Vz : z * z <= 4 * kappa * V).
      { apply (cancel c); [exact Hcp|]. assert (p * V <= 4 * c * kappa * V) by nra. lra. }
      apply (cancel (4 * kappa)); [lra|].
      assert (0 <= (z - 2 * kappa * g) * (z - 2 * kappa * g)) by apply square_nonneg.
      lra.
    - assert (P0 : p == 0) by lra.
      assert (Hs : s == 0 \/ s == 1).
      { destruct (Qlt_le_dec 0 s) as [L|L]; [right|left; lra].
        destruct (Qlt_le_dec s 1) as [M|M]; [unfold p in P0; nra|lra]. }
      assert (Hz : z == 0 /\ 0 <= V).
      { destruct Hs as [S|S].
        - assert (E : early == 0) by (apply C1; exact S).
          split; [unfold z; rewrite E, S; ring|].
          unfold V, x. rewrite E. rewrite S in B2. lra.
        - assert (E : rest == 0) by (apply C2; rewrite S; ring).
          split; [unfold z; rewrite E, S; ring|].
          unfold V, x. rewrite E. rewrite S in B1. lra. }
      destruct Hz as [Z V0].
      assert (0 <= kappa * (g * g)) by nra.
      rewrite Z. lra. }
  unfold V in Goal'. rewrite Ez at 1.
  lra.
Qed.

(** The same without a change of force: both parts together dissipate at least as much as a motion of constant speed. *)
Corollary whole_tick_damps (c s early rest d1 d2 : Q) :
  0 <= s <= 1 -> 0 <= c ->
  part_of_tick c s early d1 -> part_of_tick c (1 - s) rest d2 ->
  c * ((early + rest) * (early + rest)) <= d1 + d2.
Proof.
  intros Hs Hc H1 H2.
  destruct (Qlt_le_dec 0 c) as [L|L].
  - assert (E : exists kappa, 4 * c * kappa == s * (1 - s)).
    { exists (s * (1 - s) / (4 * c)). field. lra. }
    destruct E as [kappa E].
    assert (K0 : 0 <= kappa).
    { apply (cancel (4 * c)); [lra|]. assert (0 <= s * (1 - s)) by (apply times_nonneg; lra). lra. }
    assert (K : s * (1 - s) <= 4 * c * kappa) by lra.
    pose proof (change_of_force c s kappa early rest d1 d2 0 Hs Hc K0 K H1 H2) as P. lra.
  - assert (E : c == 0) by lra. destruct H1, H2. rewrite E. lra.
Qed.

(** * What the guard requires of a device: a new force acts late, by the mean fraction [s] of a tick *)

(** [early] and [rest] are the displacements under the old and under the new force. [damped] is the energy that the trusted
    damping dissipates in the tick. [under] is the displacement that the guard counts under the old force. For every change of
    force [g], [kappa g^2] covers the energy that the difference of [early] and [under] costs. *)
Record acts_late (c s d kappa under early rest damped : Q) : Prop := {
  damping_takes : 0 <= damped;
  early_within : Qabs early <= s * d;
  rest_within : Qabs rest <= (1 - s) * d;
  straying_is_paid : forall g,
    c * ((early + rest) * (early + rest)) - g * under - kappa * (g * g) <= damped - g * early
}.

(** A force that changes in one step, [s] ticks late. *)
Theorem pure_delay_acts_late (c s d kappa early rest d1 d2 : Q) :
  0 <= s <= 1 -> 0 <= c -> 0 <= kappa -> s * (1 - s) <= 4 * c * kappa ->
  part_of_tick c s early d1 -> part_of_tick c (1 - s) rest d2 ->
  Qabs early <= s * d -> Qabs rest <= (1 - s) * d ->
  acts_late c s d kappa (s * (early + rest)) early rest (d1 + d2).
Proof.
  intros Hs Hc Hk Hp P1 P2 He Hr. constructor; try assumption.
  - destruct P1, P2. lra.
  - intros g. pose proof (change_of_force c s kappa early rest d1 d2 g Hs Hc Hk Hp P1 P2). lra.
Qed.

(** A current loop, whose step response is a weighted mean of steps. A step comes after [at_share] ticks and has the given
    [weight]. [way] is the device's displacement until the step. [until] and [after_it] are the energies that the damping
    dissipates before and after the step; all steps share the one motion and damping of the tick. *)
Record step_response : Set := { weight : Q; at_share : Q; way : Q; until : Q; after_it : Q }.

Fixpoint mean (of_ : step_response -> Q) (steps : list step_response) : Q :=
  match steps with nil => 0 | (it :: steps)%list => weight it * of_ it + mean of_ steps end.

Lemma mean_sum (f h : step_response -> Q) (a b : Q) (steps : list step_response) :
  mean (fun it => a * f it + b * h it) steps == a * mean f steps + b * mean h steps.
Proof. induction steps as [|it steps IH]; cbn [mean]; [ring | rewrite IH; ring]. Qed.

Lemma mean_le (f h : step_response -> Q) (steps : list step_response) :
  Forall (fun it => 0 <= weight it) steps -> Forall (fun it => f it <= h it) steps -> mean f steps <= mean h steps.
Proof.
  intros W H. induction steps as [|it steps IH]; cbn [mean]; [lra|].
  inversion W as [|? ? W0 W1]; subst. inversion H as [|? ? H0 H1]; subst.
  pose proof (scaled _ _ _ W0 H0). specialize (IH W1 H1). lra.
Qed.

(** A current loop counts as a pure delay of the mean [s] of its step response, with the [kappa] of that delay. *)
Theorem current_loop_acts_late (c d kappa moved damped : Q) (steps : list step_response) :
  0 < c -> 0 <= d ->
  Forall (fun it => 0 <= weight it) steps -> mean (fun _ => 1) steps == 1 ->
  Forall (fun it => 0 <= at_share it <= 1
    /\ part_of_tick c (at_share it) (way it) (until it) /\ part_of_tick c (1 - at_share it) (moved - way it) (after_it it)
    /\ until it + after_it it <= damped
    /\ Qabs (way it) <= at_share it * d /\ Qabs (moved - way it) <= (1 - at_share it) * d) steps ->
  let s := mean at_share steps in
  s * (1 - s) <= 4 * c * kappa ->
  acts_late c s d kappa (s * moved) (mean way steps) (moved - mean way steps) damped.
Proof.
  intros Hc Hd W One All s Hk.
  assert (Const : forall q, mean (fun _ => q) steps == q).
  { intros q. assert (E : mean (fun _ => q) steps == q * mean (fun _ => 1) steps).
    { clear. induction steps as [|it steps IH]; cbn [mean]; [ring | rewrite IH; ring]. }
    rewrite E, One. ring. }
  assert (Bounds : - (s * d) <= mean way steps <= s * d
                   /\ - ((1 - s) * d) <= moved - mean way steps <= (1 - s) * d /\ 0 <= damped).
  { assert (L1 : mean way steps <= mean (fun it => d * at_share it + 0 * at_share it) steps).
    { apply mean_le; [exact W|]. eapply Forall_impl; [|exact All]. intros it H. cbn beta in *.
      destruct H as (_ & _ & _ & _ & H & _). apply Qabs_Qle_condition in H. lra. }
    assert (L2 : mean (fun it => (- d) * at_share it + 0 * at_share it) steps <= mean way steps).
    { apply mean_le; [exact W|]. eapply Forall_impl; [|exact All]. intros it H. cbn beta in *.
      destruct H as (_ & _ & _ & _ & H & _). apply Qabs_Qle_condition in H. lra. }
    assert (L3 : mean way steps <= mean (fun it => (moved + d) * 1 + (- d) * at_share it) steps).
    { apply mean_le; [exact W|]. eapply Forall_impl; [|exact All]. intros it H. cbn beta in *.
      destruct H as (_ & _ & _ & _ & _ & H). apply Qabs_Qle_condition in H. lra. }
    assert (L4 : mean (fun it => (moved - d) * 1 + d * at_share it) steps <= mean way steps).
    { apply mean_le; [exact W|]. eapply Forall_impl; [|exact All]. intros it H. cbn beta in *.
      destruct H as (_ & _ & _ & _ & _ & H). apply Qabs_Qle_condition in H. lra. }
    assert (L5 : mean (fun _ => 0) steps <= mean (fun _ => damped) steps).
    { apply mean_le; [exact W|]. eapply Forall_impl; [|exact All]. intros it H. cbn beta in *.
      destruct H as (_ & [A _ _] & [B _ _] & H & _). lra. }
    rewrite !mean_sum in *. rewrite !Const in *. fold s in L1, L2, L3, L4. split; [lra|]. split; lra. }
  destruct Bounds as (B1 & B2 & B3).
  constructor; [exact B3 | apply Qabs_Qle_condition; exact B1 | apply Qabs_Qle_condition; exact B2 |].
  intros g.
  set (k := 1 / (4 * c)).
  assert (Ek : 4 * c * k == 1) by (unfold k; field; lra).
  assert (K0 : 0 <= k) by (apply (cancel (4 * c)); lra).
  (* each step by itself, with its own delay *)
  assert (Each : mean (fun it => (c * (moved * moved)) * 1 + (- 1) * (at_share it * (g * moved) + at_share it * (1 - at_share it) * k * (g * g)))
                   steps <= mean (fun it => damped * 1 + (- g) * way it) steps).
  { apply mean_le; [exact W|]. eapply Forall_impl; [|exact All]. intros it H. cbn beta in *.
    destruct H as (Hs & P1 & P2 & Hdm & _).
    assert (S0 : 0 <= at_share it * (1 - at_share it)) by (apply times_nonneg; lra).
    assert (Kp : 0 <= at_share it * (1 - at_share it) * k) by (apply times_nonneg; assumption).
    assert (Hp : at_share it * (1 - at_share it) <= 4 * c * (at_share it * (1 - at_share it) * k)).
    { setoid_replace (4 * c * (at_share it * (1 - at_share it) * k)) with (at_share it * (1 - at_share it) * (4 * c * k)) by ring.
      rewrite Ek. lra. }
    assert (C0 : 0 <= c) by lra.
    pose proof (change_of_force c (at_share it) _ (way it) (moved - way it) _ _ g Hs C0 Kp Hp P1 P2) as P.
    assert (E : way it + (moved - way it) == moved) by ring. rewrite E in P. lra. }
  rewrite !mean_sum in Each. rewrite !Const in Each.
  (* the mean of all s (1-s) is at most s (1-s) of the mean s *)
  assert (Spread : mean (fun it => (g * moved + k * (g * g)) * at_share it + (- (k * (g * g))) * (at_share it * at_share it)) steps
                   <= s * (g * moved) + s * (1 - s) * k * (g * g)).
  { assert (J : mean (fun it => (2 * s) * at_share it + (- (s * s)) * 1) steps <= mean (fun it => at_share it * at_share it) steps).
    { apply mean_le; [exact W|]. eapply Forall_impl; [|exact All]. intros it _. cbn beta.
      pose proof (square_nonneg (at_share it - s)). lra. }
    rewrite mean_sum in *. rewrite Const in J. fold s in J |- *.
    assert (G0 : 0 <= k * (g * g)) by (apply times_nonneg; [exact K0 | apply square_nonneg]).
    pose proof (scaled _ _ _ G0 J). lra. }
  assert (Same : mean (fun it => at_share it * (g * moved) + at_share it * (1 - at_share it) * k * (g * g)) steps
                 == mean (fun it => (g * moved + k * (g * g)) * at_share it + (- (k * (g * g))) * (at_share it * at_share it)) steps).
  { clear. induction steps as [|it steps IH]; cbn [mean]; [ring | rewrite IH; ring]. }
  rewrite Same in Each.
  assert (Kappa : s * (1 - s) * k <= kappa).
  { apply (cancel (4 * c)); [lra|]. setoid_replace (4 * c * (s * (1 - s) * k)) with (s * (1 - s) * (4 * c * k)) by ring.
    rewrite Ek. lra. }
  pose proof (scaled (g * g) _ _ (square_nonneg g) Kappa).
  assert (E : mean way steps + (moved - mean way steps) == moved) by ring. rewrite E. lra.
Qed.

(** A change of force with any course over the tick, which is divided into pieces. A piece has its length in ticks, its
    displacement, the energy that the damping dissipates in it, and the fraction of the change that is still [missing] in it.
    [booked_as] is the fraction that the guard assumes to be missing: the mean [s], or, if a position is read within the tick, the
    mean over the part before or after this reading. *)
Record piece : Set := { its_share : Q; its_way : Q; its_damping : Q; missing : Q; booked_as : Q }.

Fixpoint sum (of_ : piece -> Q) (pieces : list piece) : Q :=
  match pieces with nil => 0 | (it :: pieces)%list => of_ it + sum of_ pieces end.

Lemma sum_sum (f h : piece -> Q) (a b : Q) (pieces : list piece) :
  sum (fun it => a * f it + b * h it) pieces == a * sum f pieces + b * sum h pieces.
Proof. induction pieces as [|it pieces IH]; cbn [sum]; [ring | rewrite IH; ring]. Qed.

Lemma sum_le (f h : piece -> Q) (pieces : list piece) :
  Forall (fun it => f it <= h it) pieces -> sum f pieces <= sum h pieces.
Proof.
  intros H. induction pieces as [|it pieces IH]; cbn [sum]; [lra|].
  inversion H as [|? ? H0 H1]; subst. specialize (IH H1). lra.
Qed.

(** The least energy that the damping dissipates in a piece is a parabola of the displacement, which is above each of its
    tangents. *)
Lemma tangent (c share moved damped q : Q) :
  0 <= c -> 0 <= share -> part_of_tick c share moved damped -> c * (2 * q * moved - q * q * share) <= damped.
Proof.
  intros Hc Hs [D E N].
  destruct (Qlt_le_dec 0 share) as [P|P].
  - apply (cancel share); [exact P|].
    assert (0 <= c * ((moved - q * share) * (moved - q * share))) by (apply times_nonneg; [exact Hc | apply square_nonneg]).
    lra.
  - assert (Z : share == 0) by lra. rewrite (N Z), Z. lra.
Qed.

(** (1) and (2) of docs/energy-guard.md: such a change of force counts as a delay of [s] ticks. Its [kappa] covers the differences
    of [missing] and [booked_as]. *)
Theorem told_change_acts_late (c d kappa : Q) (pieces : list piece) :
  0 < c -> 0 <= d -> sum its_share pieces == 1 ->
  Forall (fun it => 0 <= its_share it /\ part_of_tick c (its_share it) (its_way it) (its_damping it)
    /\ 0 <= missing it <= 1 /\ Qabs (its_way it) <= its_share it * d) pieces ->
  sum (fun it => its_share it * (missing it - booked_as it)) pieces == 0 ->
  sum (fun it => its_share it * ((missing it - booked_as it) * (missing it - booked_as it))) pieces <= 4 * c * kappa ->
  let s := sum (fun it => its_share it * missing it) pieces in
  acts_late c s d kappa (sum (fun it => booked_as it * its_way it) pieces)
    (sum (fun it => missing it * its_way it) pieces)
    (sum its_way pieces - sum (fun it => missing it * its_way it) pieces)
    (sum its_damping pieces).
Proof.
  intros Hc Hd One All Mean Open s.
  set (X := sum its_way pieces).
  assert (C0 : 0 <= c) by lra.
  constructor.
  - assert (H : sum (fun _ => 0) pieces <= sum its_damping pieces).
    { apply sum_le. eapply Forall_impl; [|exact All]. intros it (_ & [A _ _] & _). exact A. }
    assert (Z : sum (fun _ => 0) pieces == 0) by (clear; induction pieces as [|it p IH]; cbn [sum]; lra). lra.
  - apply Qabs_Qle_condition.
    assert (L : sum (fun it => missing it * its_way it) pieces <= sum (fun it => d * (its_share it * missing it) + 0 * its_share it) pieces).
    { apply sum_le. eapply Forall_impl; [|exact All]. intros it (_ & _ & [M _] & W). apply Qabs_Qle_condition in W.
      pose proof (scaled _ _ _ M (proj2 W)). lra. }
    assert (G : sum (fun it => (- d) * (its_share it * missing it) + 0 * its_share it) pieces <= sum (fun it => missing it * its_way it) pieces).
    { apply sum_le. eapply Forall_impl; [|exact All]. intros it (_ & _ & [M _] & W). apply Qabs_Qle_condition in W.
      pose proof (scaled _ _ _ M (proj1 W)). lra. }
    rewrite sum_sum in L, G. fold s in L, G. lra.
  - apply Qabs_Qle_condition.
    assert (E : X - sum (fun it => missing it * its_way it) pieces == sum (fun it => 1 * its_way it + (- 1) * (missing it * its_way it)) pieces)
      by (rewrite sum_sum; unfold X; ring).
    rewrite E.
    assert (L : sum (fun it => 1 * its_way it + (- 1) * (missing it * its_way it)) pieces
                <= sum (fun it => d * its_share it + (- d) * (its_share it * missing it)) pieces).
    { apply sum_le. eapply Forall_impl; [|exact All]. intros it (_ & _ & [_ M] & W). apply Qabs_Qle_condition in W.
      assert (N : 0 <= 1 - missing it) by lra. pose proof (scaled _ _ _ N (proj2 W)). lra. }
    assert (G : sum (fun it => (- d) * its_share it + d * (its_share it * missing it)) pieces
                <= sum (fun it => 1 * its_way it + (- 1) * (missing it * its_way it)) pieces).
    { apply sum_le. eapply Forall_impl; [|exact All]. intros it (_ & _ & [_ M] & W). apply Qabs_Qle_condition in W.
      assert (N : 0 <= 1 - missing it) by lra. pose proof (scaled _ _ _ N (proj1 W)). lra. }
    pose proof (sum_sum its_way (fun it => missing it * its_way it) 1 (- 1) pieces) as S0.
    pose proof (sum_sum its_share (fun it => its_share it * missing it) d (- d) pieces) as S1.
    pose proof (sum_sum its_share (fun it => its_share it * missing it) (- d) d pieces) as S2.
    cbn beta in S0, S1, S2. fold s in S1, S2. rewrite One in S1, S2. lra.
  - intros g.
    set (k := g / (2 * c)).
    assert (Ek : 2 * c * k == g) by (unfold k; field; lra).
    (* a tangent of each piece: at the mean speed X of the tick plus k off, with the k that gives the best bound *)
    set (off := fun it => missing it - booked_as it).
    assert (T : sum (fun it => c * (2 * (X + k * off it) * its_way it - (X + k * off it) * (X + k * off it) * its_share it)) pieces
                <= sum its_damping pieces).
    { apply sum_le. eapply Forall_impl; [|exact All]. intros it (S0 & P & _). apply tangent; assumption. }
    assert (E : sum (fun it => c * (2 * (X + k * off it) * its_way it - (X + k * off it) * (X + k * off it) * its_share it)) pieces
      == 2 * c * X * sum its_way pieces + 2 * c * k * (sum (fun it => missing it * its_way it) pieces - sum (fun it => booked_as it * its_way it) pieces)
         - c * X * X * sum its_share pieces - 2 * c * k * X * sum (fun it => its_share it * off it) pieces
         - c * k * k * sum (fun it => its_share it * (off it * off it)) pieces).
    { clearbody X k. clear. unfold off. induction pieces as [|it p IH]; cbn [sum]; [ring | rewrite IH; ring]. }
    rewrite E, One in T. unfold off in T. rewrite Mean in T. fold X in T.
    set (V := sum (fun it => its_share it * ((missing it - booked_as it) * (missing it - booked_as it))) pieces) in *.
    set (H := sum (fun it => missing it * its_way it) pieces) in *.
    set (B := sum (fun it => booked_as it * its_way it) pieces) in *.
    assert (K : c * k * k * V <= kappa * (g * g)).
    { assert (CK : 0 <= c * k * k) by (assert (0 <= k * k) by apply square_nonneg; assert (0 <= c * (k * k)) by (apply times_nonneg; lra); lra).
      pose proof (scaled _ _ _ CK Open) as Q1.
      assert (Q2 : c * k * k * (4 * c * kappa) == kappa * ((2 * c * k) * (2 * c * k))) by ring.
      rewrite Q2, Ek in Q1. exact Q1. }
    assert (EX : H + (X - H) == X) by ring. rewrite EX.
    rewrite Ek in T. lra.
Qed.
