(** The energy that a contact of the enhanced law can give at the HIP from its first reversal on. EnhancedStorage.v states what
    the virtual mass stores, EnhancedIsPassive.v which energy covers this. Here both are combined at the hand's side of the
    coupling. *)

Require Import ZArith Zquot Lia List Bool Psatz.
From Touchstone Require Import Guard Laws LawsArePassive Enhanced EnhancedIsPassive EnhancedOffset EnhancedStorage.
Import ListNotations.
Open Scope Z_scope.

(** Over any number of ticks the law's energy is not negative, and grows by at most what the wall takes from the mass. *)
Lemma energy_pays (L : enhanced) (m : state) (h : hand) :
  valid L -> mass_exact L = true -> carried L m -> in_format h -> stays L m h ->
  0 <= left (enhanced_run L m h) <= left m + over L (from_mass L) m h.
Proof.
  intros V Ex. revert m. induction h as [|[e moved] h IH]; intros m C F St; cbn [enhanced_run over].
  - pose proof (left_is_stored L m C). lia.
  - inversion F; subst. destruct St as [_ St]. pose proof (stays_now _ _ _ St) as Ph.
    destruct (tick_goes_on L V m e moved C Ph) as (W & G & C').
    specialize (IH _ C' H2 St).
    assert (T : enhanced_tick L m e moved = augmented L m e moved)
      by (unfold enhanced_tick; rewrite (is_augmenting L m C); reflexivity).
    assert (Mv : mass (enhanced_tick L m e moved) - mass m = mass_moved (enhanced_tick L m e moved)).
    { destruct G; cbn [moved_on mass mass_moved]; rewrite signal_same by assumption; lia. }
    destruct (mass_is_paid L m e moved V Ex C) as [E|(_ & P)]; [rewrite T, E in Ph; discriminate|].
    rewrite <- T, Mv in P. unfold from_mass at 1. lia.
Qed.

Lemma per_in (t k : Z) : 0 <= t -> 0 <= k -> 0 <= per t k <= highest_signal.
Proof.
  intros T K. unfold per, within. assert (H : 0 < highest_signal) by reflexivity.
  generalize dependent highest_signal. intros h H.
  assert (Q : 0 <= Z.quot t k).
  { destruct (Z.eq_dec k 0) as [->|N]; [rewrite Zquot_0_r; lia|]. apply Z.quot_pos; lia. }
  lia.
Qed.

Lemma one_above (h : Z) : h = highest_signal -> lowest_signal = - h - 1 /\ 0 < h.
Proof. intros ->. split; reflexivity. Qed.

(** A stretch within the format is not changed by the format's limits. *)
Lemma size_fits (x : Z) : Z.abs x <= highest_signal -> size (signal x) = Z.abs x.
Proof.
  unfold size, signal. destruct (one_above highest_signal eq_refl) as [E H]. rewrite E. clear E.
  generalize dependent highest_signal. intros h H X. lia.
Qed.

(** At the position where the mass starts, the stretch to the HIP fits the format. *)
Lemma stretch_fits (a q : Z) :
  0 < a <= highest_signal -> 0 <= q <= highest_signal ->
  Z.abs (a - signal (a - q)) <= highest_signal /\ Z.abs (a - q) <= highest_signal.
Proof.
  unfold signal. destruct (one_above highest_signal eq_refl) as [E H]. rewrite E. clear E.
  generalize dependent highest_signal. intros h H A Q. lia.
Qed.

(** The energy that is taken off for a stretch is at least that of its spring (both doubled). *)
Lemma stored_holds (k s : Z) :
  0 <= k -> 0 <= s -> k * s <= highest_signal * gain_one ->
  k * (s * s) <= gain_one * (2 * ((outward_up (k * s) * s + 1) / 2)).
Proof.
  intros K S. assert (T : 0 <= k * s) by (apply Z.mul_nonneg_nonneg; assumption).
  unfold outward_up. rewrite (Z.max_l (k * s)) by exact T.
  assert (G : 0 < gain_one) by reflexivity. generalize dependent gain_one. intros g G.
  assert (H : 0 < highest_signal) by reflexivity. generalize dependent highest_signal. intros h H C.
  pose proof (Z.mul_succ_div_gt (k * s + g - 1) g G) as U.
  assert (Le : (k * s + g - 1) / g < h + 1) by (apply Z.div_lt_upper_bound; [exact G | lia]).
  set (q := (k * s + g - 1) / g) in *. clearbody q. rewrite Z.min_l by lia.
  pose proof (Z.mul_succ_div_gt (q * s + 1) 2 ltac:(reflexivity)) as St.
  set (st := (q * s + 1) / 2) in *. clearbody st.
  assert (A : k * s <= g * q) by lia.
  assert (B : k * s * s <= g * q * s) by (apply Z.mul_le_mono_nonneg_r; assumption).
  assert (D : g * (q * s) <= g * (2 * st)) by (apply Z.mul_le_mono_nonneg_l; lia).
  lia.
Qed.

(** When the virtual mass takes over, the coupling's energy and the energy left are together at most the energy after the first
    contact, or zero if that energy was negative. *)
Theorem hand_over_adds_nothing (L : enhanced) (m : state) :
  valid L -> 0 < last m <= highest_signal -> 0 <= hip_force m <= limit L ->
  let m' := hand_over L m in
  storage L m' + 2 * gain_one * left m' <= 2 * gain_one * Z.max (left m) 0.
Proof.
  intros V Hl Hf. destruct V. unfold hand_over.
  set (place := if keep_force L then _ else _).
  assert (P : Z.abs (last m - place) <= highest_signal).
  { assert (G : 0 <= gain_one) by discriminate. unfold place. destruct (keep_force L).
    - refine (proj1 (stretch_fits (last m) (per (hip_force m * gain_one) (coupling L)) Hl _)).
      apply per_in; [apply Z.mul_nonneg_nonneg; [apply Hf | exact G] | assumption].
    - refine (proj2 (stretch_fits (last m) (per (coupling L * last m) (series L)) Hl _)).
      apply per_in; [apply Z.mul_nonneg_nonneg; [assumption|] | assumption].
      destruct Hl as [Hl _]. apply Z.lt_le_incl. exact Hl. }
  pose proof (size_fits _ P) as Sz. clearbody place. rewrite Sz. clear P Sz.
  destruct ((coupling L * Z.abs (last m - place) <=? highest_signal * gain_one)
            && (stored L (Z.abs (last m - place)) <=? left m)) eqn:Cov;
    unfold storage, stretch; cbn [last mass mass_moved left].
  - apply andb_true_iff in Cov. destruct Cov as [C1 C2]. apply Z.leb_le in C1, C2.
    pose proof (stored_holds (coupling L) (Z.abs (last m - place)) coupling_nonneg (Z.abs_nonneg _) C1) as B.
    fold (stored L (Z.abs (last m - place))) in B. rewrite Z.abs_square in B.
    set (st := stored L _) in *. clearbody st. set (w := (last m - place) * (last m - place)) in *. clearbody w. clear C1.
    assert (G : 0 < gain_one) by reflexivity. generalize dependent gain_one. intros g B G.
    assert (M : left m <= Z.max (left m) 0) by lia. set (top := Z.max (left m) 0) in *. clearbody top.
    assert (g * left m <= g * top) by (apply Z.mul_le_mono_nonneg_l; lia).
    rewrite Z.mul_0_r, Z.add_0_l. lia.
  - rewrite Z.sub_diag. assert (E : 0 * 0 = 0) by reflexivity. rewrite !E, !Z.mul_0_r. cbn [Z.add]. apply Z.le_refl.
Qed.

(** A contact from the tick at which its motion turns outward; [m] is the memory before that tick. Over any number of ticks the
    force on the HIP, times the displacement before it, gives at most the sum of three energies: what the first contact left, a
    quantum of force times the size of each displacement, and what the coupling gained while the mass was left behind. The energy
    stored and left at the end lowers this bound. *)
Theorem contact_gives_at_most_what_it_took (L : enhanced) (m : state) (e moved : Z) (h : hand) :
  valid L -> mass_exact L = true -> pressed L m -> turns e moved = true ->
  let from := hand_over L (with_left m (booked_first m moved)) in
  let window := (e, moved) :: h in
  in_format window -> stays L from window -> every L (fits L) from window -> every L (below_limit L) from window ->
  let last_one := enhanced_run L m window in
  - (2 * gain_one * over L (by_force L) from window)
  + storage L last_one + 2 * gain_one * left last_one
  <= 2 * gain_one * Z.max (booked_first m moved) 0 + 2 * gain_one * over L way from window + over L (let_go L) from window.
Proof.
  intros V Ex Pr T from window F St Fi B last_one. destruct Pr.
  assert (Le : booked_first m moved <= energy_cap) by (unfold booked_first; lia).
  destruct (hand_over_holds L (with_left m (booked_first m moved))) as [C _]; [assumption | assumption | exact Le|].
  fold from in C.
  assert (Run : last_one = enhanced_run L from window).
  { unfold last_one, window. cbn [enhanced_run]. f_equal. unfold enhanced_tick. rewrite is_first, T.
    fold from. rewrite (is_augmenting L from C). reflexivity. }
  rewrite Run. clear Run last_one.
  destruct (storage_is_kept L from window V C F St Fi) as [I D].
  destruct (force_is_the_tension_rounded L from window V C F St Fi) as [K Kb]. specialize (Kb B).
  pose proof (energy_pays L from window V Ex C F St) as P.
  pose proof (hand_over_adds_nothing L (with_left m (booked_first m moved)) V last_inside hip_force_first) as H.
  cbn zeta in H. fold from in H. cbn [with_left left] in H.
  unfold gain_one in *. lia.
Qed.
