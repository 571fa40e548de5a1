(** Whatever [Guard::new] accepts covers the device that it was told ([accepted_covers]), and one of the same delay that is no worse
    ([no_worse_is_covered]), as the guard's theorem asks of a guard ([covers], GuardLosesNothing.v). Positions are taken
    once a tick here: of one that is also taken when the force changes, the theorem does not speak. *)

Require Import ZArith QArith Qabs Qminmax Lqa Lia Bool.
From Touchstone Require Import Guard Port GuardLosesNothing GuardSettings AcceptedIsValid.
Open Scope Z_scope.

Section Told.

Context {S : settings} {T : told} {Fits : fitting}.

(** * What the theorem asks, times what clears its quotients *)

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
  - change (way_after device_told) with (inject_Z (furthest made)). change 0 with (inject_Z 0). apply Zle_Q. lia.
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
    change (r device_told) with ss. change (way_after device_told) with (inject_Z (furthest made)). change (rough device_told) with 0.
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

End Told.

(** The claims name both. *)
Arguments device_told : clear implicits.

(** * The theorems *)

Open Scope Q_scope.

(** Whatever is accepted covers the device that it was told; with a delay, that device has damping. *)
Theorem accepted_covers (S : settings) (T : told) (G : guard) :
  set_measured S = false -> accepted S T = Some G ->
  covers G (device_told S T) /\ (0 < s (device_told S T) -> 0 < c (device_told S T)).
Proof.
  intros M A. apply accepted_made in A. destruct A as [F ->].
  split; [apply made_covers | apply damping_of_a_delay]; assumption.
Qed.

(** Of the same delay, and otherwise no worse. *)
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
