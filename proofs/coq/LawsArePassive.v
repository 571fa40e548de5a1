(** What the energy observers of TDPA and FBA ensure over any number of ticks. A contact is a list of pairs of penetration and
    displacement, which are arbitrary. *)

Require Import ZArith Lia List Bool Psatz.
From Touchstone Require Import Guard Laws.
Import ListNotations.
Open Scope Z_scope.

Lemma towards_zero_is_smaller (a b : Z) : 0 < b -> Z.abs (Z.quot a b) * b <= Z.abs a.
Proof.
  intros B. rewrite <- (Z.quot_abs a b) by lia. rewrite (Z.abs_eq b) by lia.
  rewrite Z.quot_div_nonneg by lia. rewrite Z.mul_comm. apply Z.mul_div_le. exact B.
Qed.

(** The damper's energy as the code counts it is not negative and at most [c x^2]. *)
Lemma loss_is_small (c x : Z) : 0 <= c -> 0 <= damping_loss c x /\ gain_one * damping_loss c x <= c * (x * x).
Proof.
  intros Hc. unfold damping_loss, spring.
  set (q := Z.quot (c * x) gain_one).
  assert (G : 0 < gain_one) by reflexivity.
  assert (A : Z.abs q * gain_one <= Z.abs (c * x)) by (apply towards_zero_is_smaller; exact G).
  assert (H : 0 < highest_signal) by reflexivity.
  destruct (Z_le_gt_dec 0 x) as [P|P].
  - assert (Q : 0 <= q) by (apply Z.quot_pos; nia).
    assert (W : 0 <= within q highest_signal <= q) by (unfold within; lia).
    assert (B : q * gain_one <= c * x) by nia.
    set (w := within q highest_signal) in *. clearbody w q.
    split; [nia|]. assert (w * gain_one <= c * x) by nia. nia.
  - assert (Q : q <= 0).
    { unfold q. replace (c * x) with (- (c * - x)) by ring. rewrite Z.quot_opp_l by lia.
      pose proof (Z.quot_pos (c * - x) gain_one). nia. }
    assert (W : q <= within q highest_signal <= 0) by (unfold within; lia).
    assert (B : c * x <= q * gain_one) by nia.
    set (w := within q highest_signal) in *. clearbody w q.
    split; [nia|]. assert (c * x <= w * gain_one) by nia. nia.
Qed.

(** * TDPA with the thesis' observer *)

Definition contact : Set := list (Z * Z).

Fixpoint tdpa_run (L : tdpa) (m : observed) (k : contact) : observed :=
  match k with [] => m | (e, moved) :: k => tdpa_run L (tdpa_tick L m e moved) k end.

(** The thesis' sum (2.1): each force times the displacement before it, plus the counted damper energy. Outside the wall the sum
    is 0. *)
Fixpoint thesis_sum (L : tdpa) (m : observed) (k : contact) (sum : Z) : Z :=
  match k with
  | [] => sum
  | (e, moved) :: k =>
      let after := tdpa_tick L m e moved in
      let x := Z.min moved e in
      thesis_sum L after k (if e <=? 0 then 0 else sum + shown after * x + damping_loss (t_damping L) x)
  end.

Lemma thesis_step_holds (e wanted moved : Z) :
  0 <= e -> 0 <= wanted ->
  let (force, e') := thesis_step e wanted moved in
  0 <= force <= wanted /\ 0 <= e' <= e + force * moved.
Proof.
  intros He Hw. unfold thesis_step.
  destruct (0 <=? e + wanted * moved) eqn:P.
  - apply Z.leb_le in P. assert (0 < energy_cap) by reflexivity. lia.
  - apply Z.leb_gt in P. assert (M : moved < 0) by nia.
    set (q := e / - moved).
    assert (Q0 : 0 <= q) by (apply Z.div_pos; lia).
    assert (Q1 : - moved * q <= e) by (apply Z.mul_div_le; lia).
    assert (Q2 : q <= wanted).
    { assert (q < wanted + 1); [|lia]. apply Z.div_lt_upper_bound; nia. }
    assert (0 < energy_cap) by reflexivity. clearbody q. split; [lia|]. nia.
Qed.

(** At every tick of every contact the thesis' sum is at least the law's stored energy, which is never negative, whatever the hand
    does. (The sum is not the energy taken from the hand.) *)
Theorem thesis_sum_is_never_negative (L : tdpa) (k : contact) :
  exact L = false -> 0 <= t_desired L -> 0 <= t_damping L -> 0 <= t_limit L ->
  0 <= energy (tdpa_run L outside k) <= thesis_sum L outside k 0.
Proof.
  intros Form Hk Hc Hl.
  enough (G : forall m sum, 0 <= energy m <= sum ->
              0 <= energy (tdpa_run L m k) <= thesis_sum L m k sum) by (apply G; cbn; lia).
  induction k as [|[e moved] k IH]; intros m sum H; cbn [tdpa_run thesis_sum]; [exact H|].
  apply IH. unfold tdpa_tick. destruct (e <=? 0) eqn:Out; [cbn; lia|]. apply Z.leb_gt in Out.
  rewrite Form.
  destruct (loss_is_small (t_damping L) (Z.min moved e) Hc) as [L0 _].
  set (x := Z.min moved e) in *. set (loss := damping_loss (t_damping L) x) in *.
  set (wanted := Z.min (spring (t_desired L) e) (t_limit L)).
  assert (W : 0 <= wanted).
  { unfold wanted, spring, within. pose proof (Z.quot_pos (t_desired L * e) gain_one).
    assert (0 < gain_one) by reflexivity. assert (0 < highest_signal) by reflexivity.
    assert (0 <= t_desired L * e) by nia. lia. }
  set (store := Z.min (energy m + loss) energy_cap).
  assert (S0 : 0 <= store <= sum + loss) by (assert (0 < energy_cap) by reflexivity; unfold store; lia).
  pose proof (thesis_step_holds store wanted x (proj1 S0) W) as P.
  destruct (thesis_step store wanted x) as [force e'] eqn:E. cbn. lia.
Qed.

(** * FBA *)

Fixpoint fba_run (L : fba) (m : observed) (k : contact) : observed :=
  match k with [] => m | (e, moved) :: k => fba_run L (fba_tick L m e moved) k end.

(** The energy taken from the hand and by the device's damping, times [gain_one]. Each force counts over the displacement in which
    it acted. *)
Fixpoint port_sum (L : fba) (m : observed) (k : contact) (sum : Z) : Z :=
  match k with
  | [] => sum
  | (e, moved) :: k =>
      let x := Z.min moved e in
      port_sum L (fba_tick L m e moved) k
        (if e <=? 0 then 0 else sum + gain_one * (shown m * x) + f_damping L * (x * x))
  end.

(** The purpose of (2.7a): over no displacement [x] can an allowed force [f] cost more than the energy [e] and what the damping
    dissipates. *)
Lemma allowed_is_paid (c e f x : Z) :
  0 <= c -> 0 <= e -> 0 <= f <= allowed c e -> 0 <= gain_one * e + gain_one * (f * x) + c * (x * x).
Proof.
  intros Hc He [F0 F1].
  assert (R : f * gain_one <= bound c * Z.sqrt e).
  { assert (G : 0 < gain_one) by reflexivity.
    assert (B0 : 0 <= bound c) by apply Z.sqrt_nonneg.
    pose proof (Z.mul_div_le (bound c * Z.min (Z.sqrt e) highest_signal) gain_one G) as D.
    unfold allowed in F1.
    set (q := bound c * Z.min (Z.sqrt e) highest_signal / gain_one) in *.
    assert (f <= q) by lia. assert (Z.min (Z.sqrt e) highest_signal <= Z.sqrt e) by lia.
    set (r := Z.min (Z.sqrt e) highest_signal) in *. clearbody r q.
    assert (bound c * r <= bound c * Z.sqrt e) by nia. nia. }
  assert (B : bound c * bound c <= 4 * c * gain_one).
  { assert (N : 0 <= 4 * c * gain_one) by (assert (0 < gain_one) by reflexivity; nia).
    pose proof (Z.sqrt_spec _ N) as [Q _]. exact Q. }
  assert (S : Z.sqrt e * Z.sqrt e <= e) by (pose proof (Z.sqrt_spec e He) as [Q _]; exact Q).
  assert (B0 : 0 <= bound c) by apply Z.sqrt_nonneg.
  assert (S0 : 0 <= Z.sqrt e) by apply Z.sqrt_nonneg.
  set (b := bound c) in *. set (s := Z.sqrt e) in *. clearbody b s.
  assert (G : 0 < gain_one) by reflexivity. set (g := gain_one) in *. clearbody g.
  (* f^2 g <= 4 c e *)
  assert (Q1 : (f * g) * (f * g) <= (b * s) * (b * s)) by (apply Z.mul_le_mono_nonneg; nia).
  assert (Q2 : (b * b) * (s * s) <= (4 * c * g) * e) by (apply Z.mul_le_mono_nonneg; nia).
  assert (Q3 : f * f * g <= 4 * c * e) by nia.
  destruct (Z.eq_dec c 0) as [->|N].
  - assert (f = 0) by nia. nia.
  - (* 4 c (g e + g f x + c x^2) = (2 c x + g f)^2 + g (4 c e - g f^2) *)
    assert (0 <= 4 * c * (g * e + g * (f * x) + c * (x * x))); [|nia].
    replace (4 * c * (g * e + g * (f * x) + c * (x * x)))
      with ((2 * c * x + g * f) * (2 * c * x + g * f) + g * (4 * c * e - f * f * g)) by ring.
    pose proof (Z.square_nonneg (2 * c * x + g * f)). nia.
Qed.

Lemma allowed_nonneg (c e : Z) : 0 <= allowed c e.
Proof.
  unfold allowed. assert (H : 0 < highest_signal) by reflexivity. apply Z.min_glb; [|lia].
  apply Z.div_pos; [|reflexivity].
  apply Z.mul_nonneg_nonneg; [apply Z.sqrt_nonneg|].
  apply Z.min_glb; [apply Z.sqrt_nonneg | lia].
Qed.

Lemma nothing_allowed (c e : Z) : e < 0 -> allowed c e = 0.
Proof.
  intros H. unfold allowed. rewrite (Z.sqrt_neg e H).
  assert (P : 0 < highest_signal) by reflexivity. rewrite (Z.min_l 0 highest_signal) by lia.
  rewrite Z.mul_0_r. reflexivity.
Qed.

(** At every tick of any contact the energy taken from the hand and by the device's damping ([port_sum]) is not negative, and the
    observer's energy is at most that sum. After any further displacement [next] the sum is still not negative. *)
Theorem fba_is_passive (L : fba) (k : contact) (next : Z) :
  0 <= f_desired L -> 0 <= f_damping L -> 0 <= f_limit L ->
  let m := fba_run L outside k in
  let sum := port_sum L outside k 0 in
  0 <= sum /\ gain_one * energy m <= sum
  /\ 0 <= sum + gain_one * (shown m * next) + f_damping L * (next * next).
Proof.
  intros Hk Hc Hl.
  set (holds := fun m sum => 0 <= sum /\ gain_one * energy m <= sum
     /\ (0 <= energy m -> 0 <= shown m <= allowed (f_damping L) (energy m)) /\ (energy m < 0 -> shown m = 0)).
  assert (Next : forall m sum x, holds m sum -> 0 <= sum + gain_one * (shown m * x) + f_damping L * (x * x)).
  { intros m sum x (A & B & C & D). destruct (Z_lt_le_dec (energy m) 0) as [N|N].
    - rewrite (D N), Z.mul_0_l, Z.mul_0_r. pose proof (Z.square_nonneg x).
      assert (0 <= f_damping L * (x * x)) by (apply Z.mul_nonneg_nonneg; assumption). lia.
    - pose proof (allowed_is_paid _ _ _ x Hc N (C N)). lia. }
  enough (G : forall m sum, holds m sum -> holds (fba_run L m k) (port_sum L m k sum)).
  { cbn zeta. assert (H : holds (fba_run L outside k) (port_sum L outside k 0)).
    { apply G. unfold holds, outside. cbn. split; [lia|split; [lia|split; [|lia]]].
      intros _. split; [lia | apply allowed_nonneg]. }
    pose proof (Next _ _ next H). unfold holds in H. tauto. }
  induction k as [|[e moved] k IH]; intros m sum H; cbn [fba_run port_sum]; [exact H|].
  apply IH. pose proof (Next m sum (Z.min moved e) H) as N. unfold fba_tick.
  destruct (e <=? 0) eqn:Out.
  - unfold holds, outside. cbn. split; [lia|split; [lia|split; [|lia]]].
    intros _. split; [lia | apply allowed_nonneg].
  - apply Z.leb_gt in Out. destruct (loss_is_small (f_damping L) (Z.min moved e) Hc) as [L0 L1].
    set (x := Z.min moved e) in *. destruct H as (A & B & C & D).
    set (e' := Z.min (energy m + shown m * x + damping_loss (f_damping L) x) energy_cap).
    set (wanted := Z.min (spring (f_desired L) e) (f_limit L)).
    assert (W : 0 <= wanted).
    { unfold wanted, spring, within. pose proof (Z.quot_pos (f_desired L * e) gain_one).
      assert (0 < gain_one) by reflexivity. assert (0 < highest_signal) by reflexivity.
      assert (0 <= f_desired L * e) by nia. lia. }
    pose proof (allowed_nonneg (f_damping L) e') as Al.
    assert (E1 : gain_one * e' <= sum + gain_one * (shown m * x) + f_damping L * (x * x)).
    { assert (e' <= energy m + shown m * x + damping_loss (f_damping L) x) by (unfold e'; lia).
      assert (0 < gain_one) by reflexivity. nia. }
    unfold holds. cbn. split; [exact N|split; [exact E1|split; [lia|]]].
    intros Neg. rewrite (nothing_allowed _ _ Neg) in *. lia.
Qed.
