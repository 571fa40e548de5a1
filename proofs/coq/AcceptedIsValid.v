(** Every guard that [Guard::new] accepts satisfies the assumptions of the model checker's harnesses ([accepted_is_valid]). The
    lemmas before that theorem give the derived quantities of accepted settings without the limits of the arithmetic, and each
    coefficient of the guard in terms of its settings. AcceptedCovers.v uses them too. *)

Require Import ZArith Lia Bool.
From Touchstone Require Import Guard GuardLosesNothing GuardSettings.
Open Scope Z_scope.

(** * Valid guards *)

(** What the model checker's harnesses assume of a guard ([Valid for Guard], proofs/src/guard.rs), in integers: each coefficient
    is within its range, and each value that enters the guard's sums is within a quarter of its range. *)
Record valid (G : guard) : Prop := {
  valid_capacity : 0 <= capacity G < 2 ^ 53;
  valid_refill : 0 <= refill G < 2 ^ 53;
  valid_damping : 0 <= damping G <= highest_signal;
  valid_furthest : 0 <= furthest G < 2 ^ 29;
  valid_count : 0 <= count G < 2 ^ 29;
  valid_late : 0 <= late G <= 2 ^ 24;
  valid_stray : 0 <= stray G <= highest_signal;
  valid_slack : 0 <= slack G < 2 ^ 29;
  valid_per_reach : 0 <= per_reach G <= highest_signal;
  valid_in_flight : 0 <= in_flight G < 2 ^ 29;
  valid_overrun : 0 <= overrun G <= highest_signal;
  valid_largest : largest G < 2 ^ 29;
  valid_damped : damping G * furthest G / 2 ^ 12 < 2 ^ 29;
  valid_strays : stray G * (2 * largest G) / 2 ^ 24 < 2 ^ 29;
  (* the reserve of the largest force is at most the full account, which allows that force *)
  valid_reserve : largest G * in_flight G <= capacity G
}.

(** * Accepted settings, without the limits of the arithmetic *)

Ltac numbers := unfold si_one, si_most, highest_signal, up_bits, step_bits, room_bits in *.

Lemma floors (a b : Z) : 0 < b -> b * (a / b) <= a < b * (a / b) + b.
Proof. intros H. pose proof (Z.mul_div_le a b H). pose proof (Z.mul_succ_div_gt a b H). lia. Qed.

Ltac divided := Z.to_euclidean_division_equations; lia.

(** A value that passes [quarter_fits] is below a quarter of a signal's range, in units of 2^-32. *)
Lemma quarter_of (x : Z) : quarter_fits x = true -> x < 2 ^ 37.
Proof. unfold quarter_fits, signal_fits, signal_of, si_mul. rewrite Z.leb_le. numbers. divided. Qed.

(** The settings in use are accepted. It is a type class, so Coq infers it like settings and device. *)
Class fitting {S : settings} {T : told} : Prop := fit : fits = true.

Lemma accepted_made (S : settings) (T : told) (G : guard) : accepted S T = Some G -> fitting /\ G = made.
Proof. unfold accepted, fitting. destruct fits; [|discriminate]. intros E. injection E as <-. split; reflexivity. Qed.

Section Accepted.

Context {S : settings} {T : told} {Fits : fitting}.

Record checked : Prop := {
  check_capacity : 0 <= set_capacity S <= 16 * si_one;
  check_refill : 0 <= set_refill S <= si_one;
  check_damping : 0 <= set_damping S <= 1000 * si_one;
  check_share : 0 <= set_share S <= si_one;
  check_overspeed : 4294967 <= set_overspeed S <= 1000 * si_one;
  check_delay : 0 <= set_delay S <= tick_of;
  check_lag : 0 <= set_lag S <= tick_of - set_delay S;
  check_rate : 1 <= told_rate T <= 100000;
  check_count : 0 <= told_count T <= 429496730;
  check_damped : quarter_fits (si_mul damping_of distance_of) = true;
  check_distance : quarter_fits distance_of = true;
  check_strays : quarter_fits (si_mul stray_of largest_change_of) = true;
  check_in_flight : quarter_fits (si_add in_flight_of rounded_of) = true;
  check_gain : gain_fits damping_of = true;
  check_stray : signal_fits stray_of = true;
  check_per_reach : gain_fits per_reach_of = true
}.

Lemma checks : checked.
Proof.
  pose proof fit as H. unfold fits, between in H.
  repeat match goal with K : _ && _ = true |- _ => apply andb_prop in K; destruct K end.
  constructor; try assumption; split; apply Z.leb_le; assumption.
Qed.

Lemma rate_pos : 0 < told_rate T.
Proof. pose proof (check_rate checks). lia. Qed.

(** The rate is not limited by the arithmetic, because a setting has 31 binary digits before the point. *)
Lemma rate_exact : rate_of = told_rate T * si_one.
Proof. pose proof (check_rate checks). unfold rate_of. numbers. lia. Qed.

Lemma over_rate (x : Z) : 0 <= x <= si_most -> si_over x rate_of = x / told_rate T.
Proof.
  intros X. pose proof rate_pos as R. unfold si_over. rewrite rate_exact.
  destruct (Z.leb_spec (told_rate T * si_one) 0) as [L|L]; [numbers; lia|].
  rewrite Z.div_mul_cancel_r by (numbers; lia).
  apply Z.min_l. pose proof (floors x (told_rate T) R). nia.
Qed.

Lemma tick_within : 0 <= tick_of /\ told_rate T * tick_of <= si_one < told_rate T * tick_of + told_rate T.
Proof.
  pose proof rate_pos as R. unfold tick_of. rewrite over_rate by (numbers; lia).
  split; [apply Z.div_pos; numbers; lia | apply floors; exact R].
Qed.

Lemma measured_within :
  0 <= measured_of <= set_overspeed S
  /\ told_rate T * measured_of <= set_overspeed S < told_rate T * measured_of + told_rate T.
Proof.
  pose proof rate_pos as R. pose proof (check_overspeed checks).
  unfold measured_of. rewrite over_rate by (numbers; lia).
  pose proof (floors (set_overspeed S) (told_rate T) R).
  assert (0 <= set_overspeed S / told_rate T) by (apply Z.div_pos; lia). nia.
Qed.

Lemma refill_within : 0 <= refill_of /\ told_rate T * refill_of <= set_refill S.
Proof.
  pose proof rate_pos as R. pose proof (check_refill checks).
  unfold refill_of. rewrite over_rate by (numbers; lia).
  split; [apply Z.div_pos; lia | apply floors; exact R].
Qed.

Lemma distance_exact : distance_of = measured_of + told_count T + 8.
Proof.
  destruct measured_within. pose proof (check_overspeed checks). pose proof (check_count checks).
  unfold distance_of, si_add. numbers. lia.
Qed.

Lemma reach_exact : si_add reach_of rounded_of = measured_of + 2 * told_count T + 784.
Proof.
  destruct measured_within. pose proof (check_overspeed checks). pose proof (check_count checks).
  unfold rounded_of, reach_of, si_add. rewrite distance_exact. numbers. lia.
Qed.

Lemma delays : 0 <= set_delay S /\ 0 <= set_lag S /\ set_delay S + set_lag S <= tick_of <= si_one.
Proof.
  pose proof (check_delay checks). pose proof (check_lag checks). pose proof rate_pos. destruct tick_within. nia.
Qed.

Lemma late_exact :
  late_of = (set_delay S + set_lag S) * told_rate T /\ (set_delay S + set_lag S) * told_rate T <= si_one.
Proof.
  destruct delays as (A & B & C & E). pose proof rate_pos. destruct tick_within as [F [G _]].
  assert (L : (set_delay S + set_lag S) * told_rate T <= si_one) by nia.
  split; [|exact L]. unfold late_of, si_mul, si_add. rewrite rate_exact.
  rewrite (Z.min_l (_ + _)) by (numbers; lia).
  rewrite Z.mul_assoc, Z.div_mul by (numbers; lia). numbers. lia.
Qed.

Lemma trusted_within :
  0 <= trusted_of <= 1000 * si_one /\ si_one * trusted_of <= set_share S * set_damping S.
Proof.
  pose proof (check_share checks). pose proof (check_damping checks).
  unfold trusted_of, si_mul. set (p := set_share S * set_damping S).
  assert (0 <= p <= 1000 * si_one * si_one) by (unfold p; nia).
  numbers. divided.
Qed.

Lemma damping_within : 0 <= damping_of <= trusted_of * told_rate T.
Proof.
  destruct trusted_within. pose proof rate_pos. unfold damping_of, si_mul. rewrite rate_exact.
  rewrite Z.mul_assoc, Z.div_mul by (numbers; lia). numbers. nia.
Qed.

Lemma per_reach_within :
  0 <= per_reach_of /\ per_reach_of * (measured_of + 2 * told_count T + 784) <= si_one * si_one
  /\ set_capacity S * per_reach_of <= room_bits * si_one.
Proof.
  destruct measured_within as [A _]. pose proof (check_count checks). pose proof (check_capacity checks).
  unfold per_reach_of. rewrite reach_exact. set (r := measured_of + 2 * told_count T + 784).
  assert (R : 0 < r) by (unfold r; lia).
  unfold si_over.
  destruct (Z.leb_spec r 0) as [|_]; [lia|].
  pose proof (floors (si_one * si_one) r R) as F.
  assert (0 <= si_one * si_one / r) by (apply Z.div_pos; numbers; lia).
  set (f := si_one * si_one / r) in *.
  destruct (Z.leb_spec (set_capacity S) 0) as [L|L].
  - assert (E : set_capacity S = 0) by lia. rewrite E. numbers. split; [|split]; nia.
  - pose proof (floors (room_bits * si_one) (set_capacity S) L) as F2.
    assert (0 <= room_bits * si_one / set_capacity S) by (apply Z.div_pos; numbers; lia).
    set (f2 := room_bits * si_one / set_capacity S) in *.
    assert (M : 0 <= si_most) by (numbers; lia).
    set (m := Z.min (Z.min f si_most) (Z.min f2 si_most)).
    assert (0 <= m /\ m <= f /\ m <= f2) by (unfold m; lia).
    clearbody m f f2. nia.
Qed.

(** The largest change of force, and the largest force on a full account, before rounding to the number format. *)
Lemma largest_change_exact :
  largest_change_of = 2 * (set_capacity S * per_reach_of / si_one + 8)
  /\ 0 <= set_capacity S * per_reach_of / si_one <= room_bits.
Proof.
  destruct per_reach_within as (A & _ & B). pose proof (check_capacity checks).
  unfold largest_change_of, si_add, si_mul.
  set (p := set_capacity S * per_reach_of) in *. assert (0 <= p) by (unfold p; nia).
  assert (0 <= p / si_one <= room_bits) by (numbers; divided).
  split; [|assumption]. set (f := p / si_one) in *. numbers.
  rewrite (Z.min_l f) by lia. rewrite (Z.min_l (f + 8)) by lia. divided.
Qed.

Lemma share_at_most_one : 0 <= share_of <= si_one.
Proof.
  destruct delays as (A & B & C & E).
  unfold share_of, mean_of, span_of, si_add, si_over. numbers.
  destruct (0 <? _) eqn:P; [|lia]. apply Z.ltb_lt in P.
  destruct (_ <=? 0) eqn:N; [lia|]. apply Z.leb_gt in N.
  match goal with |- context [?x / ?y] => assert (0 <= x / y) by (apply Z.div_pos; destruct (set_measured S); lia) end. lia.
Qed.

(** * Each coefficient in terms of its settings *)

Ltac in_bits :=
  unfold made, energy_of, gain_of, signal_of;
  cbn [capacity refill damping furthest count late stray slack per_reach in_flight].

Lemma capacity_made : capacity made = set_capacity S * 2 ^ 16.
Proof. reflexivity. Qed.

Lemma furthest_made : 0 <= furthest made /\ 2 ^ 8 * furthest made <= measured_of.
Proof. destruct measured_within as [A _]. in_bits. divided. Qed.

Lemma damping_made : 0 <= damping made <= highest_signal /\ 2 ^ 20 * damping made <= damping_of.
Proof.
  destruct damping_within as [A _]. pose proof (check_gain checks) as F. unfold gain_fits in F. apply Z.leb_le in F.
  split; [split; [|exact F]|]; in_bits; divided.
Qed.

Lemma per_reach_made : 0 <= per_reach made <= highest_signal /\ 2 ^ 20 * per_reach made <= per_reach_of.
Proof.
  destruct per_reach_within as [A _]. pose proof (check_per_reach checks) as F. unfold gain_fits in F. apply Z.leb_le in F.
  split; [split; [|exact F]|]; in_bits; divided.
Qed.

Lemma late_made : 0 <= late made <= 2 ^ 24 /\ 2 ^ 8 * late made <= share_of < 2 ^ 8 * late made + 2 ^ 8.
Proof. pose proof share_at_most_one. in_bits. numbers. divided. Qed.

Lemma stray_nonneg : 0 <= stray_of.
Proof.
  unfold stray_of, si_over. numbers. destruct (0 <? split_of) eqn:P; [|lia]. apply Z.ltb_lt in P.
  destruct (_ <=? 0) eqn:N; [lia|]. apply Z.leb_gt in N.
  match goal with |- context [?x / ?y] => assert (0 <= x / y) by (apply Z.div_pos; lia) end. lia.
Qed.

Lemma stray_made :
  0 <= stray made <= highest_signal /\ 2 ^ 8 * stray made <= stray_of < 2 ^ 8 * stray made + 2 ^ 8 /\ stray_of < 2 ^ 39.
Proof.
  pose proof stray_nonneg. pose proof (check_stray checks) as F. unfold signal_fits in F. apply Z.leb_le in F.
  split; [split; [|exact F]|]; in_bits; unfold signal_of in F; numbers; divided.
Qed.

Lemma count_made : told_count T + 2 ^ 9 <= 2 ^ 8 * count made /\ count made <= 2 ^ 21.
Proof.
  pose proof (check_count checks). unfold made. cbn [count]. unfold signal_up, signal_add, signal_of. numbers. divided.
Qed.

Lemma in_flight_bits_nonneg : 0 <= in_flight_of.
Proof.
  pose proof (check_count checks). destruct late_exact as [L _]. destruct delays as (A & B & _). pose proof rate_pos.
  destruct measured_within as [M _].
  unfold in_flight_of, half_count, si_add, si_mul. rewrite L, distance_exact. set (K := told_count T) in *.
  assert (0 <= (set_delay S + set_lag S) * told_rate T * (measured_of + K + 8) / si_one)
    by (apply Z.div_pos; [apply Z.mul_nonneg_nonneg; nia | reflexivity]).
  assert (0 <= K / 2) by (apply Z.div_pos; lia).
  destruct (_ || _); numbers; lia.
Qed.

Lemma in_flight_made :
  in_flight_of + 2 ^ 8 < 2 ^ 8 * in_flight made <= in_flight_of + 2 ^ 9 /\ in_flight made < 2 ^ 29.
Proof.
  pose proof (quarter_of _ (check_in_flight checks)) as Q. pose proof in_flight_bits_nonneg as N.
  unfold si_add in Q. assert (E : rounded_of = 776) by reflexivity. rewrite E in Q.
  unfold made. cbn [in_flight]. unfold signal_up, signal_add, signal_of. numbers. divided.
Qed.

(** The displacement under the old force, in units of 2^-32. Delay and lag sum to at most a tick, so it is at most the largest
    displacement of a tick. *)
Lemma way_in_flight :
  let w := (set_delay S + set_lag S) * told_rate T * distance_of / si_one in
  (in_flight_of = w + 8 + told_count T / 2 \/ set_delay S + set_lag S = 0 /\ in_flight_of = told_count T / 2)
  /\ 0 <= w <= distance_of.
Proof.
  pose proof (check_count checks). destruct late_exact as [L L2]. destruct delays as (A & B & _). pose proof rate_pos.
  destruct measured_within as [M _]. pose proof (check_overspeed checks). pose proof distance_exact as E.
  intros w.
  assert (F : 0 <= (set_delay S + set_lag S) * told_rate T * distance_of) by (apply Z.mul_nonneg_nonneg; nia).
  assert (W : 0 <= w <= distance_of).
  { unfold w. split; [apply Z.div_pos; [exact F | reflexivity]|].
    apply Z.div_le_upper_bound; [reflexivity|]. apply Z.mul_le_mono_nonneg_r; lia. }
  split; [|exact W].
  unfold in_flight_of, half_count, si_mul, si_add. rewrite L. fold w. clearbody w.
  destruct (_ || _) eqn:D.
  - left. numbers. divided.
  - right. apply orb_false_elim in D. rewrite !Z.ltb_ge in D. split; [lia | reflexivity].
Qed.

(** [largest_force] of a full account, in units of 2^-32. *)
Lemma largest_made :
  0 <= largest made /\ 2 ^ 9 * largest made + 16 <= largest_change_of
  /\ 2 ^ 8 * largest made * (measured_of + 2 * told_count T + 784) <= set_capacity S * si_one.
Proof.
  destruct per_reach_made as ((P0 & _) & P). destruct largest_change_exact as [E F].
  destruct per_reach_within as (_ & R & _). pose proof (check_capacity checks) as C. pose proof (check_count checks).
  destruct measured_within as [M _].
  unfold largest, largest_force. rewrite capacity_made. unfold signal_one, gain_one.
  set (p := per_reach made) in *. set (cap := set_capacity S) in *.
  assert (F1 : 0 <= cap * 2 ^ 16 / 2 ^ 24 /\ 2 ^ 8 * (cap * 2 ^ 16 / 2 ^ 24) <= cap) by divided.
  set (x := cap * 2 ^ 16 / 2 ^ 24) in *.
  assert (G : 0 <= p * x) by (apply Z.mul_nonneg_nonneg; lia).
  assert (F2 : 0 <= p * x / 2 ^ 12 /\ 2 ^ 12 * (p * x / 2 ^ 12) <= p * x) by divided.
  set (l := p * x / 2 ^ 12) in *.
  assert (L : 2 ^ 8 * l * si_one <= cap * per_reach_of).
  { assert (2 ^ 20 * p * (2 ^ 8 * x) <= per_reach_of * cap) by (apply Z.mul_le_mono_nonneg; lia). numbers. lia. }
  split; [lia|]. split.
  - assert (2 ^ 8 * l <= cap * per_reach_of / si_one) by (apply Z.div_le_lower_bound; [reflexivity | lia]). lia.
  - set (r := measured_of + 2 * told_count T + 784) in *.
    assert (2 ^ 8 * l * si_one * r <= cap * per_reach_of * r) by (apply Z.mul_le_mono_nonneg_r; lia).
    assert (cap * (per_reach_of * r) <= cap * (si_one * si_one)) by (apply Z.mul_le_mono_nonneg_l; lia).
    numbers. lia.
Qed.

Lemma slack_made :
  slack made = told_count T / 2 / 2 ^ 8 + 4 + (largest_change_of + distance_of + set_overspeed S / 256) / si_one
                 + rounded_change
  /\ 0 <= slack made < 2 ^ 29.
Proof.
  pose proof (check_count checks). pose proof (check_overspeed checks). destruct largest_change_exact as [E F].
  pose proof (quarter_of _ (check_distance checks)). pose proof distance_exact. destruct measured_within as [M _].
  unfold made. cbn [slack]. unfold slack_of, half_count_up, left_out_of, signal_up, signal_add, signal_of, half_count, si_add.
  set (l := largest_change_of) in *. set (w := distance_of) in *. numbers.
  assert (0 <= set_overspeed S / 256 <= 2 ^ 34) by divided. set (o := set_overspeed S / 256) in *.
  assert (0 <= told_count T / 2 <= 2 ^ 28) by divided. set (k := told_count T / 2) in *.
  rewrite (Z.min_l (l + w)) by lia. rewrite (Z.min_l (l + w + o)) by lia.
  assert (0 <= (l + w + o) / 0x100000000 <= 2 ^ 10) by divided. set (n := (l + w + o) / 0x100000000) in *.
  rewrite (Z.min_l n), (Z.min_l (k + _)) by lia. rewrite (Z.mul_comm (2 ^ 8)), Z.div_add by lia.
  assert (0 <= k / 2 ^ 8 <= 2 ^ 20) by divided.
  assert (0 <= rounded_change <= 1) by (unfold rounded_change; destruct (set_measured S); lia). lia.
Qed.

(** * Accepted guards are valid *)

Lemma product_below (x y : Z) : si_mul x y < 2 ^ 37 -> x * y < 2 ^ 69.
Proof. unfold si_mul. set (p := x * y). numbers. divided. Qed.

Lemma scaled_below (x y : Z) (a b : Z) :
  0 <= a -> 0 <= b -> 2 ^ 20 * a <= x -> 2 ^ 8 * b <= y -> x * y < 2 ^ 69 -> a * b / 2 ^ 12 < 2 ^ 29.
Proof.
  intros A B X Y P. assert (2 ^ 20 * a * (2 ^ 8 * b) <= x * y) by (apply Z.mul_le_mono_nonneg; lia).
  apply Z.div_lt_upper_bound; lia.
Qed.

Theorem made_is_valid : valid made.
Proof.
  pose proof (check_capacity checks). pose proof (check_refill checks). destruct refill_within as [R1 R2].
  destruct furthest_made as [F1 F2]. destruct damping_made as [D1 D2]. destruct per_reach_made as [P1 P2].
  destruct late_made as [L1 _]. destruct stray_made as (S1 & S2 & _). destruct count_made. pose proof in_flight_bits_nonneg.
  destruct in_flight_made as [I1 I2]. destruct largest_made as (G1 & G2 & G3). destruct slack_made as [_ E].
  pose proof (check_count checks). pose proof distance_exact. pose proof rate_pos. destruct measured_within as [M _].
  pose proof (quarter_of _ (check_distance checks)). destruct largest_change_exact as [_ V].
  constructor; try lia.
  - rewrite capacity_made. numbers. lia.
  - unfold made, energy_of. cbn [refill]. numbers. nia.
  - unfold made, signal_of. cbn [overrun]. split; [apply Z.div_pos; [|reflexivity]|].
    + unfold overrun_of. destruct (signal_fits _); [|numbers; lia].
      unfold si_over. destruct (Z.leb_spec (si_mul damping_of (4 * si_one)) 0); [numbers; lia|].
      apply Z.min_glb; [apply Z.div_pos; [|assumption] | numbers; lia].
      destruct late_exact as [L _]. destruct delays as (A & B & _). unfold si_add. rewrite L. numbers. nia.
    + unfold overrun_of. set (x := si_over _ _). destruct (signal_fits x) eqn:Q; [apply Z.leb_le in Q; exact Q|].
      numbers. divided.
  - destruct largest_change_exact as [C1 C2]. numbers. lia.
  - apply (scaled_below damping_of distance_of); try lia.
    apply product_below, quarter_of, (check_damped checks).
  - assert (Q := product_below _ _ (quarter_of _ (check_strays checks))).
    apply Z.div_lt_upper_bound; [reflexivity|].
    assert (2 ^ 8 * stray made * (2 ^ 9 * largest made) <= stray_of * largest_change_of)
      by (apply Z.mul_le_mono_nonneg; lia).
    lia.
  - rewrite capacity_made.
    destruct way_in_flight as [W1 W2]. cbn zeta in W1, W2.
    set (w := (set_delay S + set_lag S) * told_rate T * distance_of / si_one) in *.
    assert (W3 : 2 ^ 8 * in_flight made <= measured_of + 2 * told_count T + 784).
    { assert (0 <= told_count T / 2 <= told_count T) by divided. lia. }
    assert (2 ^ 8 * largest made * (2 ^ 8 * in_flight made) <= 2 ^ 8 * largest made * (measured_of + 2 * told_count T + 784))
      by (apply Z.mul_le_mono_nonneg_l; lia).
    numbers. lia.
Qed.

End Accepted.

(** Every accepted guard satisfies what the model checker's harnesses assume of a guard. *)
Theorem accepted_is_valid (S : settings) (T : told) (G : guard) : accepted S T = Some G -> valid G.
Proof. intros A. apply accepted_made in A. destruct A as [F ->]. exact made_is_valid. Qed.
