(** The port where the hand is, between two samples: what a force and its displacement take from the hand, and what a damper must
    have taken out of the motion meanwhile. Positions, shares of a tick and energies are rational, in quanta: any position that a
    hand can choose is as near to one as one likes, and every statement here is about sums and products. *)

Require Import QArith Qabs Lqa.
Open Scope Q_scope.

(** A part of a tick, of the given share: it moves the device by [moved], and a damping of [c] to a whole tick takes at least
    [c moved^2 / share], however the device moves within it (Cauchy and Schwarz). In no time nothing moves. *)
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

(** (1) of docs/energy-guard.md: the two parts of a tick together. [g] is the change of force between them, [s] the share of the
    first. What a hand gains by straying from the even motion is paid by [kappa g^2]. *)
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

(** The same with no change of force: both parts together damp at least as much as an even motion. *)
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
