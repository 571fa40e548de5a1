(** Every guard that [Guard::new] accepts covers the device that its settings describe ([accepted_covers]), and every device with
    the same delay that is no worse ([no_worse_is_covered]). The guard's theorem defines what it means to cover a device
    ([covers], GuardLosesNothing.v). The device is [device_told] with one position a tick, [device_measured] with one more when
    the force changes. *)

Require Import ZArith QArith Qabs Qminmax Lqa Lia Bool.
From Touchstone Require Import Guard Port GuardLosesNothing GuardSettings AcceptedIsValid.
Open Scope Z_scope.

Section Told.

Context {S : settings} {T : told} {Fits : fitting}.

(** * The theorem's conditions, multiplied so that they contain no quotient *)

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

(** * The device that the settings describe *)

Open Scope Q_scope.

(** The exact values of the settings, not rounded. A measured position is wrong by at most half a count and one quantum. *)
Definition device_told : device :=
  let c_ := inject_Z (set_share S * set_damping S * told_rate T) / inject_Z (2 ^ 64) in
  let s_ := inject_Z ((set_delay S + set_lag S) * told_rate T) / inject_Z si_one in
  {|
    c := c_;
    s := s_;
    r := s_;
    d := inject_Z (set_overspeed S) / inject_Z (2 ^ 8 * told_rate T);
    delta := inject_Z (told_count T) / inject_Z (2 ^ 8) + 2;
    kappa := s_ * (1 - s_) / (4 * c_);
    way_after := inject_Z (furthest made);
    rough := 0
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

(** For a device with this damping, delay, speed and count, only the conditions on the change of force remain. *)
Lemma covers_if (rest kap way rou : Q) :
  let D := {| c := c device_told; s := s device_told; r := rest; d := d device_told; delta := delta device_told;
              kappa := kap; way_after := way; rough := rou |} in
  0 <= way -> 0 <= kap ->
  Qabs (rest - late made / signal_one) * way <= (distance_of + (set_overspeed S / 256)%Z) * (1 # 4294967296) ->
  kap <= (stray made + 1) / signal_one -> rou <= rounded_change ->
  covers made D.
Proof.
  intros D W0 K0 A3 K1 RO.
  pose proof made_is_valid as V. destruct V.
  pose proof share_exact as ES. pose proof way_exact as EW. pose proof delta_exact as ED.
  pose proof damping_exact as EC. pose proof rate_pos as R. destruct late_exact as [_ L]. fold late_ticks in L.
  destruct delays as (A & B & _). destruct trusted_within as [T0 T1]. destruct damping_within as [D0 D1].
  assert (Y : (0 <= late_ticks)%Z) by (unfold late_ticks; nia).
  pose proof (check_overspeed checks) as [O _]. pose proof (check_count checks) as [K _].
  assert (O1 : (0 <= set_overspeed S)%Z) by lia.
  apply Zle_Q in L, Y, O1, K. change (inject_Z 0) with 0 in *.
  assert (RQ : 0 < told_rate T) by (change 0 with (inject_Z 0); rewrite <- Zlt_Qlt; exact R).
  set (ss := s device_told) in *. set (dd := d device_told) in *. set (de := delta device_told) in *.
  constructor; unfold D; cbn [c s r d delta kappa way_after rough]; fold ss dd de; try assumption; try tauto; try lia.
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
  - destruct slack_made as [E _]. destruct largest_made as (G0 & G1 & _).
    set (ww := distance_of) in *. set (oo := (set_overspeed S / 256)%Z) in *.
    assert (OO : (0 <= oo)%Z) by (apply Z.div_pos; lia).
    assert (W1 : (0 <= ww)%Z).
    { unfold ww. rewrite distance_exact. destruct measured_within. pose proof (check_count checks). lia. }
    assert (B3 : Qmax 0 (kap - stray made / signal_one) * (2 * largest made)
                 <= 2 * largest made * (1 # 16777216)).
    { assert (0 <= largest made) by (change 0 with (inject_Z 0); apply Zle_Q; lia).
      assert (Qmax 0 (kap - stray made / signal_one) <= 1 # 16777216).
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

Section Estimated.

Hypothesis Estimated : set_measured S = false.

Open Scope Z_scope.

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

(** The error of the stored [late], times the largest measured displacement. [late] is too low by at most a quantum, or too high
    because the tick's length is rounded down. *)
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

(** A delay is accepted only with damping, and [stray] then covers its [kappa] up to a quantum. *)
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
  (* [split_of] is an upper bound of s (1 - s) ticks *)
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

Open Scope Q_scope.

(** With a delay the device has damping, so [kappa] has no division by zero. *)
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
  destruct kappa_told as [K0 K1]. destruct late_error as [A1 A2]. pose proof share_exact as ES.
  assert (F0 : 0 <= furthest made) by (change 0 with (inject_Z 0); apply Zle_Q; destruct furthest_made; lia).
  refine (covers_if (s device_told) (kappa device_told) (inject_Z (furthest made)) 0 F0 K0 _ K1 _).
  - set (ww := distance_of) in *. set (oo := (set_overspeed S / 256)%Z) in *. set (ss := s device_told) in *.
    assert (W0 : (0 <= oo)%Z) by (apply Z.div_pos; [pose proof (check_overspeed checks)|]; lia).
    assert (W1 : (0 <= ww)%Z).
    { unfold ww. rewrite distance_exact. destruct measured_within. pose proof (check_count checks). lia. }
    apply Zle_Q in A1, A2, W0, W1. in_Q A1. in_Q A2. change (inject_Z 0) with 0 in *.
    change (inject_Z (2 ^ 8)) with (256 # 1) in *.
    assert (E1 : (ss - late made / signal_one) * furthest made
                 == (late_ticks - (256 # 1) * late made) * furthest made * (1 # 4294967296)).
    { rewrite <- ES. change (inject_Z si_one) with (4294967296 # 1). change (inject_Z signal_one) with (16777216 # 1). field. }
    assert (E2 : Qabs (ss - late made / signal_one) * furthest made == Qabs ((ss - late made / signal_one) * furthest made))
      by (rewrite Qabs_Qmult, (Qabs_pos (furthest made) F0); reflexivity).
    rewrite E2, E1. apply Qabs_case; intros _; lra.
  - unfold rounded_change. rewrite Estimated. apply Qle_refl.
Qed.

End Estimated.

Section Measured.

Hypothesis Measured : set_measured S = true.

Open Scope Z_scope.

(** The rest of a tick after the delay, and the lag, in units of 2^-32 ticks. *)
Definition rest_ticks : Z := si_one - set_delay S * told_rate T.
Definition lag_ticks : Z := set_lag S * told_rate T.

Lemma lag_in_rest : 0 <= lag_ticks /\ lag_ticks <= rest_ticks /\ rest_ticks <= si_one.
Proof.
  destruct delays as (A & B & _). destruct late_exact as [_ L]. pose proof rate_pos. unfold lag_ticks, rest_ticks. nia.
Qed.

(** Bounds of [share_of], the lag as a fraction of the rest of the tick. Both the fraction and the rest are rounded down. *)
Lemma share_of_rest :
  0 < set_lag S ->
  lag_ticks * si_one <= (share_of + 1) * rest_ticks
  /\ share_of * rest_ticks <= (lag_ticks + told_rate T) * si_one
  /\ rest_ticks <= told_rate T * (tick_of - set_delay S) + told_rate T.
Proof.
  intros P. destruct delays as (A & B & C & E). destruct tick_within as [_ [F1 F2]]. pose proof rate_pos as R.
  pose proof lag_in_rest as (L0 & L1 & L2).
  unfold share_of, mean_of, span_of. rewrite Measured. destruct (Z.ltb_spec 0 (set_lag S)); [|lia].
  unfold si_over. destruct (Z.leb_spec (tick_of - set_delay S) 0) as [|T0]; [lia|].
  set (n := tick_of - set_delay S) in *. set (e := rest_ticks) in *. set (z := lag_ticks) in *. set (t := told_rate T) in *.
  assert (N1 : t * n <= e) by (unfold n, e, rest_ticks; fold t; nia).
  assert (N2 : e <= t * n + t) by (unfold n, e, rest_ticks; fold t; nia).
  assert (EZ : z = set_lag S * t) by reflexivity.
  pose proof (floors (set_lag S * si_one) n T0) as [G1 G2]. set (f := set_lag S * si_one / n) in *.
  assert (F0 : 0 <= f) by (apply Z.div_pos; numbers; lia).
  assert (F3 : f <= si_one) by (apply Z.div_le_upper_bound; numbers; nia).
  rewrite (Z.min_l f si_most), (Z.min_l f si_one) by (numbers; lia).
  assert (H1 : t * (set_lag S * si_one) <= t * (n * (f + 1))) by (apply Z.mul_le_mono_nonneg_l; lia).
  assert (H2 : (f + 1) * (t * n) <= (f + 1) * e) by (apply Z.mul_le_mono_nonneg_l; lia).
  assert (H3 : t * (n * f) <= t * (set_lag S * si_one)) by (apply Z.mul_le_mono_nonneg_l; lia).
  assert (H4 : f * e <= f * (t * n + t)) by (apply Z.mul_le_mono_nonneg_l; lia).
  assert (H5 : f * t <= si_one * t) by (apply Z.mul_le_mono_nonneg_r; lia).
  split; [rewrite EZ; lia|]. split; [rewrite EZ; lia | exact N2].
Qed.

(** A lag is accepted only with damping, and [stray] then covers its [kappa] up to a quantum. *)
Lemma stray_of_rest :
  0 < set_lag S ->
  0 < set_share S * set_damping S
  /\ lag_ticks * (rest_ticks - lag_ticks) * 2 ^ 24 * si_one
     <= 4 * (set_share S * set_damping S * told_rate T) * rest_ticks * (stray made + 1).
Proof.
  intros P. destruct delays as (A & B & C & E). pose proof rate_pos as R. pose proof lag_in_rest as (L0 & L1 & L2).
  destruct (share_of_rest P) as (S1 & _ & S3). destruct trusted_within as [U1 U2]. destruct stray_made as (N & N1 & N2).
  pose proof share_at_most_one as SH.
  assert (M0 : 0 <= tick_of - set_delay S - set_lag S <= si_one) by lia.
  assert (Split : split_of = share_of * (tick_of - set_delay S - set_lag S) / si_one + 8).
  { assert (0 <= share_of * (tick_of - set_delay S - set_lag S) <= si_one * si_one) by nia.
    unfold split_of, mean_of, span_of, si_mul, si_add. rewrite Measured.
    destruct (Z.ltb_spec 0 (set_lag S)); [|lia]. rewrite Z.max_l by lia.
    numbers. set (p := share_of * _) in *. divided. }
  set (m := tick_of - set_delay S - set_lag S) in *. set (t := told_rate T) in *. set (v := set_share S * set_damping S) in *.
  set (e := rest_ticks) in *. set (z := lag_ticks) in *. set (f := share_of) in *.
  assert (Q0 : 0 <= f * m) by (apply Z.mul_nonneg_nonneg; lia).
  pose proof (floors (f * m) si_one ltac:(reflexivity)) as [_ Q1]. rewrite <- (Z.add_simpl_r (_ / _) 8), <- Split in Q1.
  assert (Q2 : 8 <= split_of <= si_one * si_one).
  { rewrite Split. assert (0 <= f * m / si_one) by (apply Z.div_pos; [exact Q0 | reflexivity]).
    assert (f * m / si_one <= si_one) by (apply Z.div_le_upper_bound; [reflexivity | numbers; nia]). numbers. lia. }
  (* [split_of] is an upper bound of lag times (rest - lag) over the rest *)
  assert (Q3 : z * (e - z) <= split_of * (t * e)).
  { assert (H1 : z * si_one * (e - z) <= (f + 1) * e * (e - z)) by (apply Z.mul_le_mono_nonneg_r; lia).
    assert (EM : e - z <= t * m + t).
    { assert (EZ : z = set_lag S * t) by reflexivity. unfold m. lia. }
    assert (H2 : (f + 1) * (e - z) <= (f + 1) * (t * m + t)) by (apply Z.mul_le_mono_nonneg_l; lia).
    assert (H3 : f * m + m + f + 1 <= si_one * split_of) by (numbers; lia).
    assert (H4 : t * (f * m + m + f + 1) <= t * (si_one * split_of)) by (apply Z.mul_le_mono_nonneg_l; lia).
    assert (H5 : (f + 1) * (e - z) <= t * (si_one * split_of)) by lia.
    assert (H6 : e * ((f + 1) * (e - z)) <= e * (t * (si_one * split_of))) by (apply Z.mul_le_mono_nonneg_l; lia).
    apply (Z.mul_le_mono_pos_l _ _ si_one); [reflexivity|]. lia. }
  unfold stray_of in *. destruct (Z.ltb_spec 0 split_of); [|lia].
  unfold si_mul in *. assert (U3 : Z.min (trusted_of * (4 * si_one) / si_one) si_most = 4 * trusted_of) by (numbers; divided).
  rewrite U3 in *. unfold si_over in *. destruct (Z.leb_spec (4 * trusted_of) 0) as [|U4]; [numbers; lia|].
  split; [numbers; lia|].
  pose proof (floors (split_of * si_one) (4 * trusted_of) U4) as [_ V]. set (g := split_of * si_one / (4 * trusted_of)) in *.
  assert (G1 : g + 1 <= 2 ^ 8 * (stray made + 1)) by (numbers; lia).
  assert (G2 : split_of * si_one <= 4 * trusted_of * (2 ^ 8 * (stray made + 1))).
  { assert (4 * trusted_of * (g + 1) <= 4 * trusted_of * (2 ^ 8 * (stray made + 1))) by (apply Z.mul_le_mono_nonneg_l; lia). lia. }
  assert (G3 : si_one * trusted_of * (stray made + 1) <= v * (stray made + 1)) by (apply Z.mul_le_mono_nonneg_r; lia).
  assert (G4 : split_of * si_one * si_one <= 2 ^ 10 * (v * (stray made + 1))) by (numbers; lia).
  assert (TE : 0 <= t * e) by (apply Z.mul_nonneg_nonneg; lia).
  assert (G5 : t * e * (split_of * si_one * si_one) <= t * e * (2 ^ 10 * (v * (stray made + 1))))
    by (apply Z.mul_le_mono_nonneg_l; lia).
  numbers. lia.
Qed.

Open Scope Q_scope.

(** The device that the settings describe, if the position is also read when the force changes. The force begins to change after
    the delay, at the instant of this reading, and lags from then on. The displacement measured from then on is at most that at
    the over-speed limit. *)
Definition device_measured : device :=
  let rest := inject_Z lag_ticks / inject_Z rest_ticks in
  {|
    c := c device_told;
    s := s device_told;
    r := rest;
    d := d device_told;
    delta := delta device_told;
    kappa := inject_Z lag_ticks / inject_Z si_one * (1 - rest) / (4 * c device_told);
    way_after := inject_Z (set_overspeed S) * inject_Z rest_ticks / inject_Z (si_one * 2 ^ 8 * told_rate T);
    rough := 1
  |}.

Lemma damping_of_a_lag : (0 < set_lag S)%Z -> 0 < c device_told.
Proof.
  intros P. destruct (stray_of_rest P) as [V _]. pose proof rate_pos as R.
  apply Qlt_shift_div_l; [reflexivity|]. rewrite Qmult_0_l. change 0 with (inject_Z 0). rewrite <- Zlt_Qlt. nia.
Qed.

Lemma no_lag : set_lag S = 0%Z -> lag_ticks = 0%Z.
Proof. unfold lag_ticks. intros ->. reflexivity. Qed.

Lemma kappa_measured : 0 <= kappa device_measured <= (stray made + 1) / signal_one.
Proof.
  destruct stray_made as ((N & _) & _). destruct delays as (_ & B & _). pose proof lag_in_rest as (L0 & L1 & L2).
  assert (N1 : 0 <= stray made) by (change 0 with (inject_Z 0); apply Zle_Q; exact N).
  assert (N2 : 0 <= (stray made + 1) / signal_one).
  { apply Qle_shift_div_l; [reflexivity|]. rewrite Qmult_0_l. lra. }
  unfold device_measured. cbn [kappa].
  destruct (Z.eq_dec (set_lag S) 0) as [E0|P].
  - rewrite (no_lag E0). change (inject_Z 0) with 0.
    assert (E : 0 / inject_Z si_one * (1 - 0 / inject_Z rest_ticks) / (4 * c device_told) == 0)
      by (unfold Qdiv; ring).
    rewrite E. split; [apply Qle_refl | exact N2].
  - assert (P0 : (0 < set_lag S)%Z) by lia. pose proof (damping_of_a_lag P0) as C.
    destruct (stray_of_rest P0) as [V W]. pose proof damping_exact as EC. pose proof rate_pos as R.
    assert (Z0 : (0 < lag_ticks)%Z) by (unfold lag_ticks; nia).
    assert (E0 : 0 < inject_Z rest_ticks) by (change 0 with (inject_Z 0); rewrite <- Zlt_Qlt; lia).
    apply Zle_Q in W, L0, L1. in_Q W. change (inject_Z 0) with 0 in *.
    set (cc := c device_told) in *. set (z := inject_Z lag_ticks) in *. set (e := inject_Z rest_ticks) in *.
    set (x := inject_Z (stray made)) in *.
    change (inject_Z (2 ^ 64)) with (inject_Z si_one * inject_Z si_one) in EC.
    assert (K : z / inject_Z si_one * (1 - z / e) / (4 * cc) == z * (e - z) / (4 * cc * e * inject_Z si_one))
      by (field; repeat split; try discriminate; lra).
    rewrite K.
    assert (D0 : 0 < 4 * cc * e * inject_Z si_one).
    { change (inject_Z si_one) with (4294967296 # 1). pose proof (Qmult_lt_0_compat _ _ C E0) as CE.
      assert (X : 4 * cc * e * (4294967296 # 1) == (17179869184 # 1) * (cc * e)) by ring. rewrite X. lra. }
    split.
    + apply Qle_shift_div_l; [exact D0|]. rewrite Qmult_0_l. apply times_nonneg; lra.
    + apply Qle_shift_div_r; [exact D0|].
      apply (cancel (inject_Z si_one * signal_one)); [reflexivity|].
      assert (E3 : inject_Z si_one * signal_one * (z * (e - z)) == z * (e - z) * inject_Z (2 ^ 24) * inject_Z si_one)
        by (change signal_one with (2 ^ 24)%Z; ring).
      assert (E4 : inject_Z si_one * signal_one * ((x + 1) / signal_one * (4 * cc * e * inject_Z si_one))
                   == 4 * (inject_Z si_one * inject_Z si_one * cc) * e * (x + 1))
        by (field; discriminate).
      rewrite E3, E4, EC. in_Q W. rewrite ?inject_Z_mult. change (inject_Z 4) with 4 in W. exact W.
Qed.

Theorem made_covers_measured : covers made device_measured.
Proof.
  destruct kappa_measured as [K0 K1]. pose proof lag_in_rest as (L0 & L1 & L2). destruct delays as (_ & B & _).
  pose proof rate_pos as R. pose proof (check_overspeed checks) as [O _]. destruct late_made as [[M0 _] [M1 M2]].
  destruct measured_within as [Q0 [Q1 Q2]]. pose proof (check_count checks) as [CK _].
  set (den := inject_Z (si_one * 2 ^ 8 * told_rate T)).
  assert (D0 : 0 < den) by (unfold den; change 0 with (inject_Z 0); rewrite <- Zlt_Qlt; numbers; lia).
  assert (W0 : 0 <= way_after device_measured).
  { unfold device_measured. cbn [way_after]. fold den. apply Qle_shift_div_l; [exact D0|]. rewrite Qmult_0_l.
    apply times_nonneg; change 0 with (inject_Z 0); apply Zle_Q; lia. }
  refine (covers_if (r device_measured) (kappa device_measured) (way_after device_measured) 1 W0 K0 _ K1 _).
  2: { unfold rounded_change. rewrite Measured. apply Qle_refl. }
  unfold device_measured. cbn [r way_after]. fold den.
  set (oo := (set_overspeed S / 256)%Z). set (ww := distance_of).
  assert (WW : (ww = measured_of + told_count T + 8)%Z) by apply distance_exact.
  assert (OO : (set_overspeed S < 256 * oo + 256)%Z) by (unfold oo; pose proof (floors (set_overspeed S) 256 ltac:(reflexivity)); lia).
  assert (OZ : (0 <= oo)%Z) by (apply Z.div_pos; lia).
  destruct (Z.eq_dec (set_lag S) 0) as [E0|P].
  - (* without a lag *)
    assert (S0 : share_of = 0%Z).
    { unfold share_of, mean_of. rewrite Measured, E0. reflexivity. }
    assert (LZ : late made = 0%Z) by lia.
    rewrite (no_lag E0), LZ. change (inject_Z 0) with 0.
    assert (E : 0 / inject_Z rest_ticks - 0 / inject_Z signal_one == 0) by (unfold Qdiv; ring).
    rewrite E. change (Qabs 0) with 0. rewrite Qmult_0_l.
    assert (H : (0 <= ww + oo)%Z) by lia. apply Zle_Q in H. rewrite inject_Z_plus in H. change (inject_Z 0) with 0 in H. lra.
  - assert (P0 : (0 < set_lag S)%Z) by lia. destruct (share_of_rest P0) as (S1 & S2 & _).
    assert (Z0 : (0 < lag_ticks)%Z) by (unfold lag_ticks; nia).
    set (z := lag_ticks) in *. set (e := rest_ticks) in *. set (f := share_of) in *. set (l := late made) in *.
    set (o := set_overspeed S) in *. set (t := told_rate T) in *.
    (* the stored [late] is too low or too high by little, over [way] *)
    assert (A1 : (o * (z * si_one - 2 ^ 8 * l * e) <= (ww + oo) * (2 ^ 8 * t * si_one))%Z).
    { assert (H1 : (z * si_one - 2 ^ 8 * l * e <= 2 ^ 8 * si_one)%Z).
      { assert (((f + 1) * e <= (2 ^ 8 * l + 2 ^ 8) * e)%Z) by (apply Z.mul_le_mono_nonneg_r; lia). nia. }
      assert (H2 : (o * (z * si_one - 2 ^ 8 * l * e) <= o * (2 ^ 8 * si_one))%Z) by (apply Z.mul_le_mono_nonneg_l; lia).
      assert (H3 : (o <= t * (ww + oo))%Z) by nia. nia. }
    assert (A2 : (o * (2 ^ 8 * l * e - z * si_one) <= (ww + oo) * (2 ^ 8 * t * si_one))%Z).
    { assert (H1 : (2 ^ 8 * l * e - z * si_one <= t * si_one)%Z).
      { assert ((2 ^ 8 * l * e <= f * e)%Z) by (apply Z.mul_le_mono_nonneg_r; lia). lia. }
      assert (H2 : (o * (2 ^ 8 * l * e - z * si_one) <= o * (t * si_one))%Z) by (apply Z.mul_le_mono_nonneg_l; lia).
      assert (H3 : (o <= 2 ^ 8 * (ww + oo))%Z) by lia.
      assert (H4 : (o * (t * si_one) <= 2 ^ 8 * (ww + oo) * (t * si_one))%Z) by (apply Z.mul_le_mono_nonneg_r; numbers; lia).
      lia. }
    apply Zle_Q in A1, A2. in_Q A1. in_Q A2.
    assert (EE : 0 < inject_Z e) by (change 0 with (inject_Z 0); rewrite <- Zlt_Qlt; lia).
    assert (TT : 0 < inject_Z t) by (change 0 with (inject_Z 0); rewrite <- Zlt_Qlt; lia).
    set (way := inject_Z o * inject_Z e / den).
    assert (WY : 0 <= way) by exact W0.
    assert (X : (inject_Z z / inject_Z e - inject_Z l / inject_Z signal_one) * way
                == inject_Z o * (inject_Z z * inject_Z si_one - inject_Z (2 ^ 8) * inject_Z l * inject_Z e)
                   / (inject_Z si_one * (inject_Z (2 ^ 8) * inject_Z t * inject_Z si_one))).
    { unfold way, den. rewrite !inject_Z_mult. change (inject_Z signal_one) with (16777216 # 1).
      change (inject_Z (2 ^ 8)) with (256 # 1). change (inject_Z si_one) with (4294967296 # 1). field. split; lra. }
    assert (E2 : Qabs (inject_Z z / inject_Z e - inject_Z l / inject_Z signal_one) * way
                 == Qabs ((inject_Z z / inject_Z e - inject_Z l / inject_Z signal_one) * way))
      by (rewrite Qabs_Qmult, (Qabs_pos way WY); reflexivity).
    rewrite E2, X.
    set (n := inject_Z o * (inject_Z z * inject_Z si_one - inject_Z (2 ^ 8) * inject_Z l * inject_Z e)) in *.
    set (q := inject_Z (2 ^ 8) * inject_Z t * inject_Z si_one) in *.
    assert (QP : 0 < q) by (unfold q; change (inject_Z (2 ^ 8)) with (256 # 1); change (inject_Z si_one) with (4294967296 # 1); lra).
    assert (NE : - n == inject_Z o * (inject_Z (2 ^ 8) * inject_Z l * inject_Z e - inject_Z z * inject_Z si_one)) by (unfold n; ring).
    assert (B2 : - n <= (ww + oo) * q) by (rewrite NE; exact A2).
    assert (SQ : 0 < inject_Z si_one * q) by (change (inject_Z si_one) with (4294967296 # 1); lra).
    assert (EQ : (ww + oo) * (1 # 4294967296) == (ww + oo) * q / (inject_Z si_one * q))
      by (change (inject_Z si_one) with (4294967296 # 1); field; lra).
    rewrite EQ. apply Qabs_case; intros _.
    + apply Qle_shift_div_r; [exact SQ|]. 
      assert (Y : (ww + oo) * q / (inject_Z si_one * q) * (inject_Z si_one * q) == (ww + oo) * q) by (field; change (inject_Z si_one) with (4294967296 # 1); lra).
      rewrite Y. exact A1.
    + assert (Y : - (n / (inject_Z si_one * q)) == (- n) / (inject_Z si_one * q)) by (field; change (inject_Z si_one) with (4294967296 # 1); lra).
      rewrite Y. apply Qle_shift_div_r; [exact SQ|].
      assert (Y2 : (ww + oo) * q / (inject_Z si_one * q) * (inject_Z si_one * q) == (ww + oo) * q) by (field; change (inject_Z si_one) with (4294967296 # 1); lra).
      rewrite Y2. exact B2.
Qed.

End Measured.

End Told.

(** The claims name settings and device explicitly. *)
Arguments device_told : clear implicits.
Arguments device_measured : clear implicits.

(** The device that the settings describe, with one position a tick or one more when the force changes. *)
Definition device_of (S : settings) (T : told) : device :=
  if set_measured S then device_measured S T else device_told S T.

(** * The theorems *)

Open Scope Q_scope.

(** Every accepted guard covers the device that its settings describe. If that device has a lag or, with one position a tick, a
    delay or a lag, it also has damping. *)
Theorem accepted_covers (S : settings) (T : told) (G : guard) :
  accepted S T = Some G ->
  covers G (device_of S T) /\ ((0 < mean_of)%Z -> 0 < c (device_of S T)).
Proof.
  intros A. apply accepted_made in A. destruct A as [F ->]. unfold device_of, mean_of.
  destruct (set_measured S) eqn:M.
  - split; [exact (made_covers_measured M) | exact (damping_of_a_lag M)].
  - split; [exact (made_covers M)|]. intros P. apply (damping_of_a_delay M).
    unfold device_told. cbn [s]. apply Qlt_shift_div_l; [reflexivity|]. rewrite Qmult_0_l. change 0 with (inject_Z 0).
    rewrite <- Zlt_Qlt. apply Z.mul_pos_pos; [unfold si_add in P; lia | exact rate_pos].
Qed.

(** [D] has the same delay as [told_of] and is otherwise no worse. *)
Record no_worse (D told_of : device) : Prop := {
  same_share : s D == s told_of;
  same_rest : r D == r told_of;
  no_further_after : 0 <= way_after D <= way_after told_of;
  as_rough : rough D <= rough told_of;
  more_damping : c told_of <= c D;
  no_further : 0 <= d D <= d told_of;
  as_exact : 0 <= delta D <= delta told_of;
  strays_less : 0 <= kappa D <= kappa told_of
}.

Theorem no_worse_is_covered (G : guard) (D told_of : device) : covers G told_of -> no_worse D told_of -> covers G D.
Proof.
  intros [] [Es Er Ha Hr Hc Hd He Hk].
  assert (L : 0 <= largest G) by (apply Q_nonneg, largest_force_nonneg; assumption).
  assert (P : 0 <= per_reach G) by (apply Q_nonneg; assumption).
  assert (W1 : s told_of * d D <= s told_of * d told_of) by (apply scaled; lra).
  assert (W2 : (1 - s told_of) * d D <= (1 - s told_of) * d told_of) by (apply scaled; lra).
  constructor; try assumption; try lra; try (rewrite Es; lra).
  - assert (c told_of * gain_one <= c D * gain_one) by (apply Qmult_le_compat_r; [exact Hc | discriminate]). lra.
  - rewrite Es. eapply Qle_trans; [|exact reach_covers]. apply scaled; [exact P|]. lra.
  - rewrite Er. eapply Qle_trans; [|exact slack_covers].
    assert (Qabs (r told_of - late G / signal_one) * way_after D <= Qabs (r told_of - late G / signal_one) * way_after told_of)
      by (apply scaled; [apply Qabs_nonneg | lra]).
    assert (Qmax 0 (kappa D - stray G / signal_one) <= Qmax 0 (kappa told_of - stray G / signal_one))
      by (apply Q.max_le_compat_l; lra).
    assert (Qmax 0 (kappa D - stray G / signal_one) * (2 * largest G)
            <= Qmax 0 (kappa told_of - stray G / signal_one) * (2 * largest G)) by (apply Qmult_le_compat_r; lra).
    lra.
Qed.
