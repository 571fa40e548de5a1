(** What [Guard::new] makes of a person's settings (control/src/guard/settings.rs), for the format that the firmware runs: whatever it
    accepts is a guard as the model checker's harnesses assume one ([accepted_is_valid]), and covers the device that it was told
    ([accepted_covers]). So the guard's theorem holds for every accepted setting ([any_accepted_window]).

    A setting is a count of 2^-32 of its SI unit, and the code's arithmetic of settings is written out here: products and quotients are
    rounded down, and nothing is more than the largest number. compare.ml runs [accepted] beside the code. *)

Require Import ZArith QArith Qabs Qminmax Lqa Lia List Bool.
From Touchstone Require Import Guard Port GuardLosesNothing.
Open Scope Z_scope.

(** * The arithmetic of settings *)

Definition si_one : Z := 0x100000000.
Definition si_most : Z := 0x7fffffffffffffff.

Definition si_add (a b : Z) : Z := Z.min (a + b) si_most.
Definition si_mul (a b : Z) : Z := Z.min (a * b / si_one) si_most.
(** By nothing, the largest number. *)
Definition si_over (a b : Z) : Z := if b <=? 0 then si_most else Z.min (a * si_one / b) si_most.

(** A signal has 24 of the 32 digits after the point, a gain 12, an energy 48; what does not fit its word is refused. *)
Definition signal_of (x : Z) : Z := x / 2 ^ 8.
Definition gain_of (x : Z) : Z := x / 2 ^ 20.
Definition energy_of (x : Z) : Z := x * 2 ^ 16.
Definition signal_fits (x : Z) : bool := signal_of x <=? highest_signal.
Definition gain_fits (x : Z) : bool := gain_of x <=? highest_signal.
Definition energy_fits (x : Z) : bool := x <=? si_most / 2 ^ 16.
(** Four times of what the sums of the books are made of must fit. *)
Definition quarter_fits (x : Z) : bool := signal_fits (si_mul x (4 * si_one)).

Definition signal_add (a b : Z) : Z := Z.min (a + b) highest_signal.
(** A position, rounded up. *)
Definition signal_up (x : Z) : Z := signal_add (signal_of x) 1.

Definition between (least x most : Z) : bool := (least <=? x) && (x <=? most).

(** * The settings, and what is told of the device *)

Record settings : Set := {
  set_capacity : Z;    (* J *)
  set_refill : Z;      (* W *)
  set_share : Z;       (* of the damping, trusted *)
  set_damping : Z;     (* N m s/rad *)
  set_overspeed : Z;   (* rad/s *)
  set_delay : Z;       (* s *)
  set_lag : Z;         (* s *)
  set_measured : bool  (* whether the position is also read when the force changes *)
}.

Record told : Set := {
  told_rate : Z;   (* Hz, a whole number *)
  told_limit : Z;  (* of the force, N m *)
  told_count : Z   (* of the encoder, rad *)
}.

(** * Valid *)

(** What the model checker's harnesses assume of a guard ([Valid for Guard], proofs/src/guard.rs), in integers: every word within its
    ends, everything of which the books make sums within a quarter of them. *)
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
  (* the reserve of the largest force is less than the account that allows it *)
  valid_reserve : largest G * in_flight G <= capacity G
}.

(** * What they come to *)

(** More than the few last digits that a sum of products and quotients loses. *)
Definition up_bits : Z := 8.
(** A step of a signal. *)
Definition step_bits : Z := 2 ^ 8.
(** The largest force that the books have room for, 31.9. *)
Definition room_bits : Z := 137009456742.

Section Derived.

Variables (S : settings) (T : told).

Definition rate_of : Z := Z.min (told_rate T * si_one) si_most.
Definition tick_of : Z := si_over si_one rate_of.
Definition measured_of : Z := si_over (set_overspeed S) rate_of.
Definition refill_of : Z := si_over (set_refill S) rate_of.
Definition trusted_of : Z := si_mul (set_share S) (set_damping S).
Definition damping_of : Z := si_mul trusted_of rate_of.
(** The way of a tick may be measured a count longer. *)
Definition distance_of : Z := si_add (si_add measured_of (told_count T)) up_bits.
Definition reach_of : Z := si_add distance_of (told_count T).
Definition late_of : Z := si_mul (si_add (set_delay S) (set_lag S)) rate_of.

(** The reserve in flight is rounded up by a quantum and a little, and the positions that both are measured with by one each. *)
Definition rounded_of : Z := si_add (si_add (si_add step_bits step_bits) step_bits) up_bits.
Definition per_reach_of : Z :=
  Z.min (si_over si_one (si_add reach_of rounded_of)) (si_over room_bits (set_capacity S)).
Definition largest_change_of : Z := si_mul (si_add (si_mul (set_capacity S) per_reach_of) up_bits) (2 * si_one).

(** Over how much time the old force may have gone on, in the mean, of how much. *)
Definition span_of : Z := if set_measured S then tick_of - set_delay S else tick_of.
Definition mean_of : Z := if set_measured S then set_lag S else si_add (set_delay S) (set_lag S).
Definition share_of : Z := if 0 <? mean_of then Z.min (si_over mean_of span_of) si_one else 0.
Definition split_of : Z :=
  if 0 <? mean_of then si_add (si_mul share_of (Z.max (span_of - mean_of) 0)) up_bits else 0.
Definition stray_of : Z := if 0 <? split_of then si_over split_of (si_mul trusted_of (4 * si_one)) else 0.

Definition half_count : Z := told_count T / 2.
Definition left_out_of : Z := si_add (si_add largest_change_of distance_of) (set_overspeed S / 256).
(** Half a count, and what is left out: its units and the rest, a quantum each. The position and the part under the old force are rounded
    by one each. *)
Definition half_count_up : Z := si_add half_count (step_bits * (Z.min (left_out_of / si_one) 0xffff + 1)).
Definition slack_of : Z := signal_add (signal_add (signal_up half_count_up) 1) 1.
Definition in_flight_of : Z :=
  if (0 <? set_delay S) || (0 <? set_lag S)
  then si_add (si_add (si_mul late_of distance_of) up_bits) half_count
  else half_count.
Definition overrun_of : Z :=
  let whole := si_over (si_add (si_add late_of up_bits) si_one) (si_mul damping_of (4 * si_one)) in
  if signal_fits whole then whole else 127 * si_one.

(** [validate], and every conversion that may be refused. *)
Definition fits : bool :=
  between 0 (set_capacity S) (16 * si_one) && between 0 (set_refill S) si_one &&
  between 0 (set_damping S) (1000 * si_one) && between 0 (set_share S) si_one &&
  between 4294967 (set_overspeed S) (1000 * si_one) &&
  between 0 (set_delay S) si_one && between 0 (set_lag S) si_one &&
  between 0 (told_limit T) (1000 * si_one) && between 0 (told_count T) 429496730 &&
  between 0 (set_delay S) tick_of && between 0 (set_lag S) (tick_of - set_delay S) &&
  signal_fits (told_limit T) && quarter_fits (set_capacity S) &&
  quarter_fits (si_mul damping_of distance_of) && quarter_fits distance_of && quarter_fits refill_of &&
  quarter_fits (si_mul stray_of largest_change_of) && signal_fits half_count_up &&
  quarter_fits (si_add in_flight_of rounded_of) &&
  energy_fits (set_capacity S) && energy_fits refill_of && gain_fits damping_of && signal_fits measured_of &&
  signal_fits (told_count T) && signal_fits share_of && signal_fits stray_of && gain_fits per_reach_of &&
  signal_fits in_flight_of.

Definition made : guard := {|
  capacity := energy_of (set_capacity S);
  refill := energy_of refill_of;
  damping := gain_of damping_of;
  furthest := signal_of measured_of;
  count := signal_add (signal_add (signal_up (told_count T)) 1) 1;
  late := signal_of share_of;
  stray := signal_of stray_of;
  slack := slack_of;
  per_reach := gain_of per_reach_of;
  in_flight := signal_add (signal_up in_flight_of) 1;
  overrun := signal_of overrun_of
|}.

(** [Guard::new]. *)
Definition accepted : option guard := if fits then Some made else None.

(** * What was accepted, in plain numbers *)

(** The control rate of [Settings] is at most 100,000 Hz; as a setting it has 31 digits before the point. One of none is refused. *)
Hypothesis Rate : 0 <= told_rate T < 2 ^ 31.
Hypothesis Fits : fits = true.

Ltac numbers := unfold si_one, si_most, highest_signal, up_bits, step_bits, room_bits in *.

Lemma floors (a b : Z) : 0 < b -> b * (a / b) <= a < b * (a / b) + b.
Proof. intros H. pose proof (Z.mul_div_le a b H). pose proof (Z.mul_succ_div_gt a b H). lia. Qed.

Ltac divided := Z.to_euclidean_division_equations; lia.

Record checked : Prop := {
  check_capacity : 0 <= set_capacity S <= 16 * si_one;
  check_refill : 0 <= set_refill S <= si_one;
  check_damping : 0 <= set_damping S <= 1000 * si_one;
  check_share : 0 <= set_share S <= si_one;
  check_overspeed : 4294967 <= set_overspeed S <= 1000 * si_one;
  check_delay : 0 <= set_delay S <= tick_of;
  check_lag : 0 <= set_lag S <= tick_of - set_delay S;
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
  pose proof Fits as H. unfold fits, between in H.
  repeat match goal with K : _ && _ = true |- _ => apply andb_prop in K; destruct K end.
  constructor; try assumption; split; apply Z.leb_le; assumption.
Qed.

(** Below a quarter: the word itself, in bits of a setting. *)
Lemma quarter_of (x : Z) : quarter_fits x = true -> x < 2 ^ 37.
Proof. unfold quarter_fits, signal_fits, signal_of, si_mul. rewrite Z.leb_le. numbers. divided. Qed.

Lemma rate_exact : rate_of = told_rate T * si_one.
Proof. unfold rate_of. numbers. lia. Qed.

Lemma over_rate (x : Z) : 0 < told_rate T -> 0 <= x <= si_most -> si_over x rate_of = x / told_rate T.
Proof.
  intros R X. unfold si_over. rewrite rate_exact.
  destruct (Z.leb_spec (told_rate T * si_one) 0) as [L|L]; [numbers; lia|].
  rewrite Z.div_mul_cancel_r by (numbers; lia).
  apply Z.min_l. pose proof (floors x (told_rate T) R). nia.
Qed.

(** At no rate a tick has no end, and neither has its way. *)
Lemma rate_pos : 0 < told_rate T.
Proof.
  destruct (Z.eq_dec (told_rate T) 0) as [Z0|]; [|lia].
  pose proof (quarter_of _ (check_distance checks)) as H. pose proof (check_count checks).
  assert (E : measured_of = si_most).
  { unfold measured_of. replace rate_of with 0 by (rewrite rate_exact, Z0; reflexivity). reflexivity. }
  unfold distance_of, si_add in H. rewrite E in H. numbers. lia.
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

(** What a force on a full account comes to, before it is rounded to the words. *)
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

(** ** The words, each beside the setting that it is made of *)

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

(** The way under the old force, in bits: a tick of delays comes to one, and nothing else is more. *)
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

(** [largest_force] of a full account, in bits. *)
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
  assert (0 <= k / 2 ^ 8 <= 2 ^ 20) by divided. lia.
Qed.

(** ** Valid: what the model checker's harnesses assume *)

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

(** ** What the theorem asks, times what clears its quotients *)

Definition late_ticks : Z := (set_delay S + set_lag S) * told_rate T.

Lemma flight_enough :
  2 * (set_delay S + set_lag S) * set_overspeed S + si_one * told_count T + 2 ^ 9 * si_one <= 2 ^ 9 * si_one * in_flight made.
Proof.
  destruct way_in_flight as [W [W0 _]]. cbn zeta in W, W0. destruct in_flight_made as [[I _] _].
  destruct measured_within as [M [_ O]]. pose proof distance_exact as E. pose proof rate_pos. destruct delays as (A & B & _).
  pose proof (check_count checks) as K. pose proof (check_overspeed checks).
  set (a := set_delay S + set_lag S) in *. set (o := set_overspeed S) in *. set (k := told_count T) in *.
  assert (H2 : k <= 2 * (k / 2) + 1) by divided.
  destruct W as [W|[W1 W2]].
  - set (p := a * told_rate T * distance_of) in *.
    assert (P : a * o <= p).
    { unfold p. rewrite <- Z.mul_assoc. apply Z.mul_le_mono_nonneg_l; [unfold a; lia|]. rewrite E. nia. }
    pose proof (floors p si_one ltac:(reflexivity)) as F. numbers. lia.
  - rewrite W1. numbers. lia.
Qed.

Lemma reach_enough :
  2 * (si_one - late_ticks) * set_overspeed S
  + told_rate T * si_one * (2 ^ 9 * in_flight made + told_count T + 2 ^ 9)
  <= 2 * told_rate T * si_one * (measured_of + 2 * told_count T + 784).
Proof.
  destruct way_in_flight as [W _]. cbn zeta in W. destruct in_flight_made as [[_ I] _].
  destruct measured_within as [M [_ O]]. pose proof distance_exact as E. pose proof rate_pos as R.
  destruct late_exact as [_ L]. destruct delays as (A & B & _). pose proof (check_count checks) as K.
  pose proof (check_overspeed checks) as P. unfold late_ticks.
  set (a := set_delay S + set_lag S) in *. set (o := set_overspeed S) in *. set (k := told_count T) in *.
  set (r := told_rate T) in *. set (q := measured_of) in *.
  assert (H2 : 2 * (k / 2) <= k) by divided. set (h := k / 2) in *.
  destruct W as [W|[W1 W2]].
  - set (y := a * r) in *. assert (Y : 0 <= y) by (unfold y; apply Z.mul_nonneg_nonneg; unfold a; lia).
    pose proof (floors (y * distance_of) si_one ltac:(reflexivity)) as [F _]. rewrite E in F.
    set (e := o - r * q).
    assert (X : 2 * (si_one - y) * e <= 2 * (si_one - y) * (r * (k + 8))).
    { apply Z.mul_le_mono_nonneg_l; [numbers; lia|]. unfold e. nia. }
    assert (Z1 : si_one * (2 ^ 9 * in_flight made) <= 2 * (y * (q + k + 8)) + si_one * (1040 + k)).
    { rewrite E in W. numbers. lia. }
    assert (Z2 : r * (si_one * (2 ^ 9 * in_flight made)) <= r * (2 * (y * (q + k + 8)) + si_one * (1040 + k)))
      by (apply Z.mul_le_mono_nonneg_l; lia).
    replace o with (r * q + e) by (unfold e; lia). numbers. lia.
  - rewrite W1 in *. assert (Z1 : 2 ^ 9 * in_flight made <= k + 1024) by lia.
    assert (Z2 : r * (2 ^ 9 * in_flight made) <= r * (k + 1024)) by (apply Z.mul_le_mono_nonneg_l; lia).
    numbers. nia.
Qed.

Hypothesis Estimated : set_measured S = false.

Lemma share_within : late_ticks <= share_of <= late_ticks + told_rate T.
Proof.
  destruct delays as (A & B & C & E). destruct tick_within as [_ [F1 F2]]. pose proof rate_pos as R.
  unfold late_ticks, share_of, mean_of, span_of, si_add. rewrite Estimated.
  rewrite Z.min_l by (numbers; lia). set (a := set_delay S + set_lag S) in *. set (t := tick_of) in *.
  destruct (Z.ltb_spec 0 a) as [P|P]; [|nia].
  unfold si_over. destruct (Z.leb_spec t 0) as [|T0]; [lia|].
  pose proof (floors (a * si_one) t T0) as [G1 G2]. set (f := a * si_one / t) in *.
  assert (H1 : a * told_rate T <= f).
  { assert (a * (told_rate T * t) <= a * si_one) by (apply Z.mul_le_mono_nonneg_l; lia). nia. }
  assert (H2 : f <= a * told_rate T + told_rate T).
  { assert (a * si_one <= a * (told_rate T * t + told_rate T)) by (apply Z.mul_le_mono_nonneg_l; lia).
    assert (a * told_rate T <= t * told_rate T) by (apply Z.mul_le_mono_nonneg_r; lia). nia. }
  assert (H3 : f <= si_one) by (apply Z.div_le_upper_bound; nia).
  assert (0 <= a * told_rate T) by nia. numbers. lia.
Qed.

(** The share as stored, wrong by a quantum or by what a tick's digits leave out, over the longest displacement. *)
Lemma late_error :
  (late_ticks - 2 ^ 8 * late made) * furthest made <= distance_of
  /\ (2 ^ 8 * late made - late_ticks) * furthest made <= set_overspeed S / 256.
Proof.
  destruct share_within as [S1 S2]. destruct late_made as [_ L]. destruct furthest_made as [F1 F2].
  destruct measured_within as [_ [M _]]. pose proof distance_exact. pose proof (check_count checks). pose proof rate_pos.
  set (f := furthest made) in *. split.
  - assert ((late_ticks - 2 ^ 8 * late made) * f <= 2 ^ 8 * f) by (apply Z.mul_le_mono_nonneg_r; lia). lia.
  - assert ((2 ^ 8 * late made - late_ticks) * f <= told_rate T * f) by (apply Z.mul_le_mono_nonneg_r; lia).
    assert (told_rate T * (2 ^ 8 * f) <= told_rate T * measured_of) by (apply Z.mul_le_mono_nonneg_l; lia).
    assert (told_rate T * f <= set_overspeed S / 256) by (apply Z.div_le_lower_bound; lia). lia.
Qed.

(** Without damping a delay is refused. *)
Lemma stray_enough :
  0 < set_delay S + set_lag S ->
  0 < set_share S * set_damping S
  /\ late_ticks * (si_one - late_ticks) * 2 ^ 24 <= 4 * (set_share S * set_damping S * told_rate T) * (stray made + 1).
Proof.
  intros P. destruct share_within as [S1 _]. destruct delays as (A & B & C & E). destruct tick_within as [_ [_ F]].
  pose proof rate_pos as R. destruct late_exact as [_ Y]. fold late_ticks in Y.
  destruct trusted_within as [U1 U2]. destruct stray_made as (N & N1 & N2). pose proof share_at_most_one as SH.
  assert (Split : split_of = share_of * (tick_of - (set_delay S + set_lag S)) / si_one + 8).
  { assert (0 <= share_of * (tick_of - (set_delay S + set_lag S)) <= si_one * si_one) by nia.
    unfold split_of, mean_of, span_of, si_mul, si_add. rewrite Estimated.
    rewrite (Z.min_l (set_delay S + set_lag S)) by (numbers; lia).
    destruct (Z.ltb_spec 0 (set_delay S + set_lag S)); [|lia]. rewrite Z.max_l by lia.
    numbers. set (p := share_of * _) in *. divided. }
  set (a := set_delay S + set_lag S) in *. set (t := tick_of) in *. set (v := set_share S * set_damping S) in *.
  assert (Q0 : 0 <= share_of * (t - a)) by (apply Z.mul_nonneg_nonneg; lia).
  pose proof (floors (share_of * (t - a)) si_one ltac:(reflexivity)) as [_ Q1]. rewrite <- (Z.add_simpl_r (_ / _) 8), <- Split in Q1.
  assert (Q2 : 8 <= split_of <= si_one * si_one).
  { rewrite Split. assert (0 <= share_of * (t - a) / si_one) by (apply Z.div_pos; [exact Q0 | reflexivity]).
    assert (share_of * (t - a) / si_one <= si_one) by (apply Z.div_le_upper_bound; [reflexivity | numbers; nia]). numbers. lia. }
  (* what the split is for *)
  assert (Q3 : late_ticks * (si_one - late_ticks) <= told_rate T * (si_one * split_of)).
  { assert (H1 : late_ticks * (t - a) <= share_of * (t - a)) by (apply Z.mul_le_mono_nonneg_r; lia).
    assert (H2 : a * (si_one - told_rate T * t) <= a * told_rate T) by (apply Z.mul_le_mono_nonneg_l; lia).
    assert (EL : late_ticks = a * told_rate T) by reflexivity. rewrite EL in *.
    assert (H3 : told_rate T * (a * (si_one - a * told_rate T)) <= told_rate T * (si_one * split_of))
      by (apply Z.mul_le_mono_nonneg_l; numbers; lia).
    lia. }
  unfold stray_of in *. destruct (Z.ltb_spec 0 split_of); [|lia].
  unfold si_mul in *. assert (U3 : Z.min (trusted_of * (4 * si_one) / si_one) si_most = 4 * trusted_of) by (numbers; divided).
  rewrite U3 in *. unfold si_over in *. destruct (Z.leb_spec (4 * trusted_of) 0) as [|U4]; [numbers; lia|].
  split; [numbers; lia|].
  pose proof (floors (split_of * si_one) (4 * trusted_of) U4) as [_ V]. set (f := split_of * si_one / (4 * trusted_of)) in *.
  assert (G1 : f + 1 <= 2 ^ 8 * (stray made + 1)) by (numbers; lia).
  assert (G2 : split_of * si_one <= 4 * trusted_of * (2 ^ 8 * (stray made + 1))).
  { assert (4 * trusted_of * (f + 1) <= 4 * trusted_of * (2 ^ 8 * (stray made + 1))) by (apply Z.mul_le_mono_nonneg_l; lia). lia. }
  assert (G3 : si_one * trusted_of * (stray made + 1) <= v * (stray made + 1)) by (apply Z.mul_le_mono_nonneg_r; lia).
  assert (G4 : split_of * si_one * si_one <= 2 ^ 10 * (v * (stray made + 1))) by (numbers; lia).
  assert (G5 : told_rate T * (split_of * si_one * si_one) <= told_rate T * (2 ^ 10 * (v * (stray made + 1))))
    by (apply Z.mul_le_mono_nonneg_l; lia).
  numbers. lia.
Qed.

(** * The device that is told *)

Open Scope Q_scope.

(** The numbers of the settings themselves, not rounded. A position is wrong by half a count, and by a quantum of its own word. *)
Definition device_told : device :=
  let c_ := inject_Z (set_share S * set_damping S * told_rate T) / inject_Z (2 ^ 64) in
  let s_ := inject_Z ((set_delay S + set_lag S) * told_rate T) / inject_Z si_one in
  {|
    c := c_;
    s := s_;
    d := inject_Z (set_overspeed S) / inject_Z (2 ^ 8 * told_rate T);
    delta := inject_Z (told_count T) / inject_Z (2 ^ 8) + 2;
    kappa := s_ * (1 - s_) / (4 * c_)
  |}.

Lemma share_exact : inject_Z si_one * s device_told == late_ticks.
Proof. unfold device_told, late_ticks. cbn [s]. field. discriminate. Qed.

Lemma way_exact : inject_Z (2 ^ 8) * told_rate T * d device_told == set_overspeed S.
Proof.
  unfold device_told. cbn [d]. rewrite inject_Z_mult. field. split; [|discriminate].
  pose proof rate_pos as R. intros E.
  change 0 with (inject_Z 0) in E. rewrite inject_Z_injective in E. lia.
Qed.

Lemma delta_exact : inject_Z (2 ^ 9) * (delta device_told * (1 # 2)) == told_count T + 512.
Proof. unfold device_told. cbn [delta]. change (inject_Z (2 ^ 9)) with (512 # 1). change (inject_Z (2 ^ 8)) with (256 # 1). field. Qed.

Lemma damping_exact : inject_Z (2 ^ 64) * c device_told == (set_share S * set_damping S * told_rate T)%Z.
Proof. unfold device_told. cbn [c]. field. discriminate. Qed.

(** Where a force straddles two ticks, the damping is there: [kappa] is no quotient by nothing. *)
Lemma damping_of_a_delay : 0 < s device_told -> 0 < c device_told.
Proof.
  intros P. assert (L : (0 < set_delay S + set_lag S)%Z).
  { destruct delays as (A & B & _). destruct (Z.eq_dec (set_delay S + set_lag S) 0) as [E|]; [|lia].
    unfold device_told in P. cbn [s] in P. rewrite E in P. discriminate P. }
  destruct (stray_enough L) as [V _]. pose proof rate_pos as R.
  apply Qlt_shift_div_l; [reflexivity|]. rewrite Qmult_0_l. change 0 with (inject_Z 0). rewrite <- Zlt_Qlt. nia.
Qed.

Lemma kappa_told : 0 <= kappa device_told <= (stray made + 1) / signal_one.
Proof.
  destruct stray_made as ((N & _) & _). pose proof share_exact as E. destruct late_exact as [_ L].
  destruct delays as (A & B & _). pose proof rate_pos as R.
  assert (N1 : 0 <= stray made) by (change 0 with (inject_Z 0); apply Zle_Q; exact N).
  assert (N2 : 0 <= (stray made + 1) / signal_one).
  { apply Qle_shift_div_l; [reflexivity|]. rewrite Qmult_0_l. lra. }
  change (kappa device_told) with (s device_told * (1 - s device_told) / (4 * c device_told)).
  destruct (Z.eq_dec (set_delay S + set_lag S) 0) as [E0|P].
  - assert (E1 : s device_told == 0).
    { unfold device_told. cbn [s]. rewrite E0. reflexivity. }
    assert (E2 : s device_told * (1 - s device_told) / (4 * c device_told) == 0).
    { unfold Qdiv. rewrite E1. rewrite !Qmult_0_l. reflexivity. }
    rewrite E2. split; [apply Qle_refl | exact N2].
  - assert (P0 : (0 < set_delay S + set_lag S)%Z) by lia.
    destruct (stray_enough P0) as [V W]. fold late_ticks in L.
    assert (Y : (0 <= late_ticks)%Z) by (unfold late_ticks; nia).
    assert (C : 0 < c device_told).
    { apply Qlt_shift_div_l; [reflexivity|]. rewrite Qmult_0_l. change 0 with (inject_Z 0). rewrite <- Zlt_Qlt. nia. }
    pose proof damping_exact as EC.
    apply Zle_Q in W, L, Y. in_Q W. change (inject_Z 0) with 0 in *.
    set (cc := c device_told) in *. set (ss := s device_told) in *. set (y := inject_Z late_ticks) in *.
    set (v := inject_Z (set_share S * set_damping S * told_rate T)) in *. set (x := inject_Z (stray made)) in *.
    change (inject_Z (2 ^ 64)) with (inject_Z si_one * inject_Z si_one) in EC.
    assert (S0 : 0 <= ss <= 1).
    { split; apply (cancel (inject_Z si_one)); try reflexivity; rewrite E; lra. }
    split.
    + apply Qle_shift_div_l; [lra|]. rewrite Qmult_0_l. apply times_nonneg; lra.
    + apply Qle_shift_div_r; [lra|].
      apply (cancel (inject_Z si_one * inject_Z si_one * signal_one)); [reflexivity|].
      assert (E3 : inject_Z si_one * inject_Z si_one * signal_one * (ss * (1 - ss))
                   == (inject_Z si_one * ss) * (inject_Z si_one - inject_Z si_one * ss) * inject_Z (2 ^ 24))
        by (change signal_one with (2 ^ 24)%Z; ring).
      assert (E4 : inject_Z si_one * inject_Z si_one * signal_one * ((x + 1) / signal_one * (4 * cc))
                   == inject_Z 4 * (inject_Z si_one * inject_Z si_one * cc) * (x + 1))
        by (change (inject_Z 4) with 4; field; discriminate).
      rewrite E3, E4, E, EC. unfold v. in_Q W. rewrite ?inject_Z_mult. exact W.
Qed.

Theorem made_covers : covers made device_told.
Proof.
  pose proof made_is_valid as V. destruct V.
  destruct kappa_told as [K0 K1]. pose proof share_exact as ES. pose proof way_exact as EW. pose proof delta_exact as ED.
  pose proof damping_exact as EC. pose proof rate_pos as R. destruct late_exact as [_ L]. fold late_ticks in L.
  destruct delays as (A & B & _). destruct trusted_within as [T0 T1]. destruct damping_within as [D0 D1].
  assert (Y : (0 <= late_ticks)%Z) by (unfold late_ticks; nia).
  pose proof (check_overspeed checks) as [O _]. pose proof (check_count checks) as [K _].
  assert (O1 : (0 <= set_overspeed S)%Z) by lia.
  apply Zle_Q in L, Y, O1, K. change (inject_Z 0) with 0 in *.
  assert (RQ : 0 < told_rate T) by (change 0 with (inject_Z 0); rewrite <- Zlt_Qlt; exact R).
  set (ss := s device_told) in *. set (dd := d device_told) in *. set (de := delta device_told) in *.
  constructor; fold ss dd de; try tauto; try lia.
  - split; apply (cancel (inject_Z si_one)); try reflexivity; rewrite ES; lra.
  - apply (cancel (inject_Z (2 ^ 64))); [reflexivity|]. rewrite EC. change (inject_Z (2 ^ 64) * 0) with (inject_Z 0).
    apply Zle_Q. nia.
  - apply (cancel (inject_Z (2 ^ 8) * told_rate T)); [change (inject_Z (2 ^ 8)) with (256 # 1); lra|]. rewrite EW. lra.
  - change (inject_Z (2 ^ 9)) with (512 # 1) in ED. lra.
  - destruct damping_made as [_ M]. apply (cancel (inject_Z (2 ^ 52))); [reflexivity|].
    assert (E : inject_Z (2 ^ 52) * (c device_told * gain_one) == inject_Z (2 ^ 64) * c device_told).
    { change (inject_Z (2 ^ 64)) with (inject_Z (2 ^ 52) * inject_Z gain_one). ring. }
    rewrite E, EC, <- inject_Z_mult. apply Zle_Q.
    assert (si_one * trusted_of * told_rate T <= set_share S * set_damping S * told_rate T)%Z
      by (apply Z.mul_le_mono_nonneg_r; lia).
    numbers. lia.
  - destruct count_made as [M _]. apply Zle_Q in M. in_Q M.
    change (inject_Z (2 ^ 9)) with (512 # 1) in *. change (inject_Z (2 ^ 8)) with (256 # 1) in *. lra.
  - pose proof flight_enough as M. apply Zle_Q in M. in_Q M.
    assert (E : inject_Z si_one * inject_Z (2 ^ 8) * (ss * dd) == (set_delay S + set_lag S)%Z * set_overspeed S).
    { rewrite <- EW. setoid_replace (inject_Z si_one * inject_Z (2 ^ 8) * (ss * dd))
        with (inject_Z si_one * ss * (inject_Z (2 ^ 8) * dd)) by ring.
      rewrite ES. unfold late_ticks. rewrite inject_Z_mult. ring. }
    rewrite inject_Z_plus in E.
    apply (cancel (inject_Z si_one * inject_Z (2 ^ 9))); [reflexivity|].
    change (inject_Z (2 ^ 9)) with (512 # 1) in *. change (inject_Z (2 ^ 8)) with (256 # 1) in *.
    change (inject_Z si_one) with (4294967296 # 1) in *. change (inject_Z 2) with (2 # 1) in *. lra.
  - destruct per_reach_made as [[P0 _] P]. destruct per_reach_within as (_ & P2 & _).
    set (r := (measured_of + 2 * told_count T + 784)%Z) in *.
    assert (R0 : (0 <= r)%Z) by (destruct measured_within; pose proof (check_count checks); unfold r; lia).
    assert (P3 : (2 ^ 20 * per_reach made * r <= si_one * si_one)%Z).
    { assert (2 ^ 20 * per_reach made * r <= per_reach_of * r)%Z by (apply Z.mul_le_mono_nonneg_r; lia). lia. }
    pose proof reach_enough as M. fold r in M. apply Zle_Q in M, P3, P0, R0. in_Q M. in_Q P3. change (inject_Z 0) with 0 in *.
    assert (X : (1 - ss) * dd + in_flight made + de * (1 # 2) <= r * (1 # 256)).
    { apply (cancel (2 * told_rate T * inject_Z si_one * 256)).
      - assert (0 < told_rate T * inject_Z si_one) by (change (inject_Z si_one) with (4294967296 # 1); lra). lra.
      - assert (E : 2 * told_rate T * inject_Z si_one * 256 * ((1 - ss) * dd + in_flight made + de * (1 # 2))
                    == 2 * (inject_Z si_one - inject_Z si_one * ss) * (inject_Z (2 ^ 8) * told_rate T * dd)
                       + told_rate T * inject_Z si_one * (inject_Z (2 ^ 9) * in_flight made)
                       + told_rate T * inject_Z si_one * (inject_Z (2 ^ 9) * (de * (1 # 2)))).
        { change (inject_Z (2 ^ 8)) with (256 # 1). change (inject_Z (2 ^ 9)) with (512 # 1). ring. }
        rewrite E, ES, EW, ED.
        change (inject_Z (2 ^ 9)) with (512 # 1) in *. change (inject_Z 2) with (2 # 1) in *. lra. }
    apply (cancel (inject_Z (2 ^ 28))); [reflexivity|].
    assert (X2 : per_reach made * ((1 - ss) * dd + in_flight made + de * (1 # 2)) <= per_reach made * (r * (1 # 256)))
      by (apply scaled; assumption).
    change (inject_Z (2 ^ 28)) with (268435456 # 1). change (inject_Z (2 ^ 20)) with (1048576 # 1) in P3.
    change (inject_Z gain_one) with (4096 # 1). change (inject_Z signal_one) with (16777216 # 1).
    change (inject_Z si_one) with (4294967296 # 1) in *. lra.
  - destruct late_error as [A1 A2]. destruct slack_made as [E _]. destruct largest_made as (G0 & G1 & _).
    set (ww := distance_of) in *. set (oo := (set_overspeed S / 256)%Z) in *.
    assert (W0 : (0 <= oo)%Z) by (apply Z.div_pos; lia).
    assert (W1 : (0 <= ww)%Z).
    { unfold ww. rewrite distance_exact. destruct measured_within. pose proof (check_count checks). lia. }
    assert (F0 : 0 <= furthest made) by (change 0 with (inject_Z 0); apply Zle_Q; lia).
    assert (A3 : Qabs (ss - late made / signal_one) * furthest made <= (ww + oo) * (1 # 4294967296)).
    { apply Zle_Q in A1, A2, W0, W1. in_Q A1. in_Q A2. change (inject_Z 0) with 0 in *.
      change (inject_Z (2 ^ 8)) with (256 # 1) in *.
      assert (E1 : (ss - late made / signal_one) * furthest made
                   == (late_ticks - (256 # 1) * late made) * furthest made * (1 # 4294967296)).
      { rewrite <- ES. change (inject_Z si_one) with (4294967296 # 1). change (inject_Z signal_one) with (16777216 # 1). field. }
      apply Qabs_case; intros _; lra. }
    assert (B3 : Qmax 0 (kappa device_told - stray made / signal_one) * (2 * largest made)
                 <= 2 * largest made * (1 # 16777216)).
    { assert (0 <= largest made) by (change 0 with (inject_Z 0); apply Zle_Q; lia).
      assert (Qmax 0 (kappa device_told - stray made / signal_one) <= 1 # 16777216).
      { apply Q.max_lub; [discriminate|].
        assert (E1 : (stray made + 1) / signal_one == stray made / signal_one + (1 # 16777216))
          by (change (inject_Z signal_one) with (16777216 # 1); field).
        lra. }
      nra. }
    assert (C1 : (largest_change_of + ww + oo < si_one * ((largest_change_of + ww + oo) / si_one + 1))%Z)
      by (pose proof (floors (largest_change_of + ww + oo) si_one ltac:(reflexivity)); lia).
    assert (C2 : (told_count T < 2 ^ 9 * (told_count T / 2 / 2 ^ 8 + 1))%Z) by divided.
    set (h := (told_count T / 2 / 2 ^ 8)%Z) in *. set (l := ((largest_change_of + ww + oo) / si_one)%Z) in *.
    assert (C3 : (2 ^ 9 * largest made + ww + oo <= si_one * (l + 1))%Z) by lia.
    assert (C4 : (told_count T <= 2 ^ 9 * (h + 1))%Z) by lia.
    apply Zle_Q in C3, C4. in_Q C3. in_Q C4. rewrite E, !inject_Z_plus.
    change (inject_Z (2 ^ 9)) with (512 # 1) in *. change (inject_Z si_one) with (4294967296 # 1) in *.
    change (inject_Z 4) with (4 # 1). change (inject_Z 1) with (1 # 1) in *. lra.
Qed.

End Derived.

(** * The theorems *)

Open Scope Q_scope.

Lemma accepted_made (S : settings) (T : told) (G : guard) : accepted S T = Some G -> fits S T = true /\ G = made S T.
Proof. unfold accepted. destruct (fits S T); [|discriminate]. intros E. injection E as <-. split; reflexivity. Qed.

(** Whatever is accepted is what the model checker's harnesses assume of a guard. *)
Theorem accepted_is_valid (S : settings) (T : told) (G : guard) :
  (0 <= told_rate T < 2 ^ 31)%Z -> accepted S T = Some G -> valid G.
Proof. intros R A. apply accepted_made in A. destruct A as [F ->]. apply made_is_valid; assumption. Qed.

(** Whatever is accepted covers the device that it was told; with a delay, that device has damping. *)
Theorem accepted_covers (S : settings) (T : told) (G : guard) :
  (0 <= told_rate T < 2 ^ 31)%Z -> set_measured S = false -> accepted S T = Some G ->
  covers G (device_told S T) /\ (0 < s (device_told S T) -> 0 < c (device_told S T)).
Proof.
  intros R M A. apply accepted_made in A. destruct A as [F ->].
  split; [apply made_covers | apply damping_of_a_delay]; assumption.
Qed.

(** Of the same delay, and otherwise no worse. *)
Record no_worse (D told_of : device) : Prop := {
  same_share : s D == s told_of;
  more_damping : c told_of <= c D;
  no_further : 0 <= d D <= d told_of;
  as_exact : 0 <= delta D <= delta told_of;
  strays_less : 0 <= kappa D <= kappa told_of
}.

Theorem no_worse_is_covered (G : guard) (D told_of : device) : covers G told_of -> no_worse D told_of -> covers G D.
Proof.
  intros [] [Es Hc Hd He Hk].
  assert (L : 0 <= largest G) by (apply Q_nonneg, largest_force_nonneg; assumption).
  assert (P : 0 <= per_reach G) by (apply Q_nonneg; assumption).
  assert (W1 : s told_of * d D <= s told_of * d told_of) by (apply scaled; lra).
  assert (W2 : (1 - s told_of) * d D <= (1 - s told_of) * d told_of) by (apply scaled; lra).
  constructor; try assumption; try lra; try (rewrite Es; lra).
  - assert (c told_of * gain_one <= c D * gain_one) by (apply Qmult_le_compat_r; [exact Hc | discriminate]). lra.
  - rewrite Es. eapply Qle_trans; [|exact reach_covers]. apply scaled; [exact P|]. lra.
  - rewrite Es. eapply Qle_trans; [|exact slack_covers].
    assert (Qmax 0 (kappa D - stray G / signal_one) <= Qmax 0 (kappa told_of - stray G / signal_one))
      by (apply Q.max_le_compat_l; lra).
    assert (Qmax 0 (kappa D - stray G / signal_one) * (2 * largest G)
            <= Qmax 0 (kappa told_of - stray G / signal_one) * (2 * largest G)) by (apply Qmult_le_compat_r; lra).
    lra.
Qed.

(** A quantum of energy is 2^-48 J, and one of a setting 2^-32. *)
Definition joules (quanta : Q) : Q := quanta / inject_Z (2 ^ 48).
Definition si (x : Z) : Q := inject_Z x / inject_Z si_one.

(** The largest force pays for half a count, with what the capacity is for the whole reach. *)
Lemma bound_in_settings (S : settings) (T : told) (n : Q) :
  (0 <= told_rate T < 2 ^ 31)%Z -> fits S T = true -> 0 <= n ->
  let error := si (told_count T) / 2 + (1 # 2 ^ 24) in
  let way := si (set_overspeed S) / told_rate T in
  joules (capacity (made S T) + refill (made S T) * n + largest (made S T) * (delta (device_told S T) * (1 # 2)))
  <= si (set_capacity S) * (1 + error / (way + 2 * si (told_count T))) + si (set_refill S) / told_rate T * n.
Proof.
  intros R F N error way.
  destruct (largest_made S T R F) as (L0 & _ & L). destruct (measured_within S T R F) as [_ [_ M]].
  destruct (refill_within S T R F) as [_ P]. pose proof (delta_exact S T) as E.
  pose proof (rate_pos S T R F) as RP. pose proof (check_count _ _ (checks S T F)) as [K _].
  pose proof (check_overspeed _ _ (checks S T F)) as [O _]. assert (O' : (1 <= set_overspeed S)%Z) by lia.
  assert (C1 : capacity (made S T) == set_capacity S * 65536) by (rewrite capacity_made, inject_Z_mult; reflexivity).
  assert (C2 : refill (made S T) == refill_of S T * 65536) by (unfold made, energy_of; cbn [refill]; rewrite inject_Z_mult; reflexivity).
  unfold joules. rewrite C1, C2.
  set (l := largest (made S T)) in *. set (q := measured_of S T) in *. set (f := refill_of S T) in *. clearbody l q f.
  assert (L2 : (told_rate T * (2 ^ 8 * l * (q + 2 * told_count T + 784)) <= told_rate T * (set_capacity S * si_one))%Z)
    by (apply Z.mul_le_mono_nonneg_l; lia).
  assert (L3 : (2 ^ 8 * l * (set_overspeed S + 2 * told_rate T * told_count T) <= told_rate T * (set_capacity S * si_one))%Z).
  { assert (2 ^ 8 * l * (set_overspeed S + 2 * told_rate T * told_count T)
            <= 2 ^ 8 * l * (told_rate T * (q + 2 * told_count T + 784)))%Z by (apply Z.mul_le_mono_nonneg_l; lia). lia. }
  apply Zle_Q in L3, P, L0, K, O'. in_Q L3. in_Q P.
  assert (RQ : 0 < told_rate T) by (change 0 with (inject_Z 0); rewrite <- Zlt_Qlt; exact RP).
  set (r := inject_Z (told_rate T)) in *. set (k := inject_Z (told_count T)) in *. set (o := inject_Z (set_overspeed S)) in *.
  set (C := inject_Z (set_capacity S)) in *. set (ll := inject_Z l) in *.
  change (inject_Z (2 ^ 9)) with (512 # 1) in *. change (inject_Z (2 ^ 8)) with (256 # 1) in *. change (inject_Z 2) with 2 in *.
  change (inject_Z si_one) with (4294967296 # 1) in *. change (inject_Z 0) with 0 in *. change (inject_Z 1) with 1 in *.
  unfold si in *. fold k o C in way, error |- *. change (inject_Z si_one) with (4294967296 # 1) in *.
  change (inject_Z (2 ^ 48)) with (281474976710656 # 1).
  assert (RK : 0 <= r * k) by (apply times_nonneg; lra).
  set (w := way + 2 * (k / (4294967296 # 1))).
  assert (EW : (4294967296 # 1) * r * w == o + 2 * r * k) by (unfold w, way; field; lra).
  assert (W0 : 0 < w).
  { apply Qnot_le_lt. intros H. assert (r * w <= 0) by (setoid_replace 0 with (r * 0) by ring; apply scaled; lra). lra. }
  assert (LW : ll * w <= C * (1 # 256)).
  { apply (cancel ((256 # 1) * ((4294967296 # 1) * r))); [lra|].
    assert (X : (256 # 1) * ((4294967296 # 1) * r) * (ll * w) == (256 # 1) * ll * ((4294967296 # 1) * r * w)) by ring.
    rewrite X, EW. lra. }
  assert (EE : error == k * (1 # 8589934592) + (1 # 16777216)) by (unfold error; change (2 ^ 24)%positive with 16777216%positive; field).
  assert (E0 : 0 <= error) by lra.
  assert (LE : ll * error <= C * (1 # 256) * (error / w)).
  { assert (X : C * (1 # 256) * (error / w) == C * (1 # 256) * error / w) by (field; lra). rewrite X.
    apply Qle_shift_div_l; [exact W0|].
    pose proof (scaled error _ _ E0 LW). lra. }
  assert (ED : delta (device_told S T) * (1 # 2) == (16777216 # 1) * error) by lra.
  rewrite ED.
  assert (FN : inject_Z f * n <= inject_Z (set_refill S) / r * n).
  { apply Qmult_le_compat_r; [|exact N]. apply Qle_shift_div_l; [exact RQ | lra]. }
  set (x := error / w) in *.
  assert (X1 : inject_Z (set_refill S) / (4294967296 # 1) / r * n == inject_Z (set_refill S) / r * n * (1 # 4294967296)) by (field; lra).
  assert (X2 : C / (4294967296 # 1) == C * (1 # 4294967296)) by field.
  rewrite X1, X2. set (y := inject_Z (set_refill S) / r * n) in *.
  apply Qle_shift_div_r; [reflexivity|]. lra.
Qed.

(** In a window of [n] ticks, any hand gets out of a device that is no worse than the told one at most

      C (1 + e / (v T + 2 k)) + P T n

    with any law before the guard and whatever was before: [C] and [P] the capacity and the refill as they were set, [k] the count,
    [e] half of it and a quantum, [v T] the way of a tick at overspeed. *)
Theorem any_accepted_window (S : settings) (T : told) (G : guard) (D : device)
    (error0 : Q) (before window : list event) (early rest damped : Q) :
  (0 <= told_rate T < 2 ^ 31)%Z -> set_measured S = false -> accepted S T = Some G -> no_worse D (device_told S T) ->
  Qabs error0 <= delta D * (1 # 2) ->
  let begin := run G (power_up G error0) before in
  let w := run G begin window in
  all_may_precede G D (power_up G error0) before ->
  all_possible G D begin window ->
  Qabs early <= s D * d D -> Qabs rest <= (1 - s D) * d D -> 0 <= damped ->
  let port_took := taken w - taken begin + older (memory_of w) * early + force (memory_of w) * rest + damped in
  let error := si (told_count T) / 2 + (1 # 2 ^ 24) in
  let way := si (set_overspeed S) / told_rate T in
  joules (- port_took)
  <= si (set_capacity S) * (1 + error / (way + 2 * si (told_count T)))
     + si (set_refill S) / told_rate T * inject_Z (Z.of_nat (length window)).
Proof.
  intros R M A B E0 begin w Hb Hw He Hr Hd port_took error way.
  destruct (accepted_covers S T G R M A) as [K _]. pose proof (no_worse_is_covered _ _ _ K B) as KD.
  pose proof (any_window_by_settings G D KD error0 before window early rest damped E0 Hb Hw He Hr Hd) as H.
  cbn zeta in H. fold begin w port_took in H.
  apply accepted_made in A. destruct A as [F ->].
  assert (N : 0 <= inject_Z (Z.of_nat (length window))) by (apply Q_nonneg, Zle_0_nat).
  eapply Qle_trans; [|apply (bound_in_settings S T _ R F N)].
  unfold joules. apply Qmult_le_compat_r; [|discriminate].
  assert (L : 0 <= largest (made S T)) by (apply Q_nonneg; apply (largest_made S T R F)).
  destruct B as [_ _ _ [_ X] _].
  assert (largest (made S T) * (delta D * (1 # 2)) <= largest (made S T) * (delta (device_told S T) * (1 # 2)))
    by (apply scaled; [exact L | lra]).
  lra.
Qed.
