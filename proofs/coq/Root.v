(** Integer square roots as the code computes them: digit by digit from the highest (control/src/magnitude.rs, [root]), and the
    root of a double word from that of its upper half (control/src/space/root.rs; Zimmermann, Karatsuba square root, 1999). Both
    equal [Z.sqrt]. *)

Require Import ZArith Lia.
Open Scope Z_scope.

(** * Digit by digit *)

(** Sets the binary digit [place] of the root if the square is then not more than the number. *)
Definition digit (n root place : Z) : Z :=
  let candidate := Z.lor root (2 ^ place) in
  if candidate * candidate <=? n then candidate else root.

Fixpoint digits (n root : Z) (places : nat) : Z :=
  match places with
  | O => root
  | S below => digits n (digit n root (Z.of_nat below)) below
  end.

Lemma one_more_digit (q place : Z) :
  0 <= place -> Z.lor (q * 2 ^ (place + 1)) (2 ^ place) = q * 2 ^ (place + 1) + 2 ^ place.
Proof.
  intros H.
  assert (apart : Z.land (q * 2 ^ (place + 1)) (2 ^ place) = 0).
  { apply Z.bits_inj'. intros i Hi. rewrite Z.land_spec, Z.bits_0, Z.pow2_bits_eqb by assumption.
    destruct (Z.eqb_spec place i) as [<-|]; [|apply Bool.andb_false_r].
    rewrite Z.mul_pow2_bits_low by lia. reflexivity. }
  rewrite <- (Z.lxor_lor _ _ apart). symmetry. apply Z.add_nocarry_lxor. exact apart.
Qed.

Lemma digits_end (n : Z) (places : nat) : forall q,
  let one := 2 ^ Z.of_nat places in
  q * one * (q * one) <= n < (q * one + one) * (q * one + one) -> 0 <= q ->
  let root := digits n (q * one) places in root * root <= n < (root + 1) * (root + 1).
Proof.
  induction places as [|below IH]; intros q one H Hq; cbn [digits].
  - subst one. cbn in *. lia.
  - subst one. rewrite Nat2Z.inj_succ, <- Z.add_1_r in *. unfold digit.
    rewrite one_more_digit by lia.
    replace (2 ^ (Z.of_nat below + 1)) with (2 * 2 ^ Z.of_nat below) in * by (rewrite Z.pow_add_r by lia; ring).
    set (one := 2 ^ Z.of_nat below) in *.
    replace (q * (2 * one) + one) with ((2 * q + 1) * one) in * by ring.
    replace (q * (2 * one)) with ((2 * q) * one) in * by ring.
    destruct (Z.leb_spec ((2 * q + 1) * one * ((2 * q + 1) * one)) n) as [fits|fits].
    + apply (IH (2 * q + 1)); [|lia]. fold one. replace ((2 * q + 1) * one + one) with (2 * q * one + 2 * one) by ring. lia.
    + apply (IH (2 * q)); [|lia]. fold one. replace (2 * q * one + one) with ((2 * q + 1) * one) by ring. lia.
Qed.

(** With as many digits as the root can have, the result is the root. *)
Theorem digits_are_the_root (n : Z) (bits : nat) : 0 <= n < 4 ^ Z.of_nat bits -> digits n 0 bits = Z.sqrt n.
Proof.
  intros H. symmetry. apply Z.sqrt_unique.
  pose proof (digits_end n bits 0) as found. cbn zeta in found. rewrite Z.mul_0_l in found.
  rewrite <- Z.add_1_r. apply found; [|lia].
  replace (4 ^ Z.of_nat bits) with (2 ^ Z.of_nat bits * 2 ^ Z.of_nat bits) in H
    by (rewrite <- Z.pow_mul_l; reflexivity).
  lia.
Qed.

(** The root of a 64-bit number: 32 digits. *)
Definition root_by_digits (n : Z) : Z := digits n 0 32.

(** * By halves *)

(** [it] is the root of [n], rounded down, and the remainder. *)
Definition is_root (n : Z) (it : Z * Z) : Prop :=
  let (root, rest) := it in root * root + rest = n /\ 0 <= rest <= 2 * root.

(** The root of a number of four half words, from the root of its upper two. A half word has [half] values. *)
Definition level (below : Z -> Z * Z) (half n : Z) : Z * Z :=
  let word := half * half in
  let (root, rest) := below (n / word) in
  let low := n mod word in
  let (a, b) := (low / half, low mod half) in
  let dividend := rest * (half / 2) + a / 2 in
  let found_digit := dividend / root in
  let left := (dividend - found_digit * root) * 2 + a mod 2 in
  let found := root * half + found_digit in
  let have := left * half + b in
  let need := found_digit * found_digit in
  if need <=? have then (found, have - need) else (found - 1, have - need + found + (found - 1)).

Theorem level_is_root (below : Z -> Z * Z) (h n : Z) :
  0 < h -> (forall high, h * h <= high < 4 * (h * h) -> is_root high (below high)) ->
  4 * (h * h) * (h * h) <= n < 16 * (h * h) * (h * h) -> is_root n (level below (2 * h) n).
Proof.
  intros Hh is_below Hn. unfold level.
  set (half := 2 * h). set (word := half * half).
  assert (Hword : 0 < word) by (unfold word, half; nia).
  assert (Hhigh : h * h <= n / word < 4 * (h * h)).
  { split; [apply Z.div_le_lower_bound | apply Z.div_lt_upper_bound]; unfold word, half; nia. }
  specialize (is_below _ Hhigh). destruct (below (n / word)) as [root rest]. unfold is_root in is_below.
  destruct is_below as [square Hrest].
  assert (Hn' := Z.div_mod n word ltac:(lia)). assert (Hlow := Z.mod_pos_bound n word Hword).
  set (low := n mod word) in *. rewrite <- square in Hn', Hhigh. clear square.
  assert (Hlow' := Z.div_mod low half ltac:(unfold half; lia)).
  assert (Hb := Z.mod_pos_bound low half ltac:(unfold half; lia)).
  assert (Ha : 0 <= low / half < half).
  { split; [apply Z.div_pos; unfold half in *; lia | apply Z.div_lt_upper_bound; unfold word, half in *; lia]. }
  set (a := low / half) in *. set (b := low mod half) in *.
  assert (Ha' := Z.div_mod a 2 ltac:(lia)). assert (Hodd := Z.mod_pos_bound a 2 ltac:(lia)).
  set (a2 := a / 2) in *. set (odd := a mod 2) in *.
  assert (Hroot : h <= root < half).
  { split.
    - enough (h < root + 1) by lia. apply Z.square_lt_simpl_nonneg; lia.
    - apply Z.square_lt_simpl_nonneg; unfold half; lia. }
  replace (half / 2) with h by (unfold half; rewrite Z.mul_comm, Z.div_mul; lia).
  assert (Hd := Z.div_mod (rest * h + a2) root ltac:(lia)).
  assert (Hleft := Z.mod_pos_bound (rest * h + a2) root ltac:(lia)).
  assert (Hdigit : 0 <= (rest * h + a2) / root <= half).
  { split; [apply Z.div_pos; [|lia]; assert (0 <= rest * h) by (apply Z.mul_nonneg_nonneg; lia); lia|].
    enough ((rest * h + a2) / root < half + 1) by lia.
    apply Z.div_lt_upper_bound; [lia|]. unfold half in *.
    assert (rest * h <= 2 * root * h) by (apply Z.mul_le_mono_nonneg_r; lia). lia. }
  set (found_digit := (rest * h + a2) / root) in *. set (over := (rest * h + a2) mod root) in *.
  replace (rest * h + a2 - found_digit * root) with over by lia.
  assert (Hsum : n = (root * half + found_digit) * (root * half + found_digit) - found_digit * found_digit + ((over * 2 + odd) * half + b)).
  { unfold word in *.
    assert (H : rest * half + a = 2 * (root * found_digit + over) + odd) by (unfold half; lia).
    rewrite Hn', Hlow'. transitivity (root * root * half * half + half * (rest * half + a) + b); [ring|].
    rewrite H. ring. }
  assert (Hhave : 0 <= (over * 2 + odd) * half + b <= 2 * (root * half) - 1).
  { assert (0 <= (over * 2 + odd) * half) by (apply Z.mul_nonneg_nonneg; lia).
    assert ((over * 2 + odd) * half <= (2 * root - 1) * half) by (apply Z.mul_le_mono_nonneg_r; lia). lia. }
  set (have := (over * 2 + odd) * half + b) in *.
  assert (Hneed : 0 <= found_digit * found_digit <= half * half).
  { split; [apply Z.mul_nonneg_nonneg | apply Z.mul_le_mono_nonneg]; lia. }
  assert (Hsome : 0 < found_digit * found_digit -> 0 < found_digit) by (destruct (Z.eq_dec found_digit 0) as [->|]; lia).
  assert (Hlarge : half * half <= 2 * root * half) by (apply Z.mul_le_mono_nonneg_r; unfold half; lia).
  clearbody half have found_digit. clear - Hsum Hhave Hdigit Hneed Hsome Hlarge.
  destruct (Z.leb_spec (found_digit * found_digit) have) as [fits|fits]; unfold is_root; split; lia.
Qed.

(** Every intermediate value fits its type in the code. Dividend, digit and remainder of the division are words. The root found,
    the square of its last digit and the rest are double words. *)
Theorem level_fits (h root rest a b : Z) :
  0 < h -> h <= root < 2 * h -> 0 <= rest <= 2 * root -> 0 <= a < 2 * h -> 0 <= b < 2 * h ->
  let half := 2 * h in let word := half * half in
  let dividend := rest * h + a / 2 in
  let found_digit := dividend / root in
  let left := (dividend - found_digit * root) * 2 + a mod 2 in
  0 <= rest * h < word /\ 0 <= dividend < word /\ 0 <= found_digit < word /\ 0 <= found_digit * root <= dividend /\
  0 <= left < word /\ 0 <= left * half + b < word * word /\ 0 <= root * half + found_digit < word * word /\
  0 <= found_digit * found_digit < word * word.
Proof.
  intros Hh Hroot Hrest Ha Hb half word dividend found_digit left.
  assert (Ha' := Z.div_mod a 2 ltac:(lia)). assert (Hodd := Z.mod_pos_bound a 2 ltac:(lia)).
  assert (H0 : 0 <= rest * h) by (apply Z.mul_nonneg_nonneg; lia).
  assert (H1 : rest * h <= 2 * root * h) by (apply Z.mul_le_mono_nonneg_r; lia).
  assert (H2 : 2 * root * h <= 2 * (2 * h - 1) * h) by (apply Z.mul_le_mono_nonneg_r; lia).
  assert (Hdividend : 0 <= dividend < word) by (unfold dividend, word, half; lia).
  assert (Hd := Z.div_mod dividend root ltac:(lia)). assert (Hover := Z.mod_pos_bound dividend root ltac:(lia)).
  fold found_digit in Hd. set (over := dividend mod root) in *.
  assert (Hdigit : 0 <= found_digit <= half).
  { split; [apply Z.div_pos; lia|]. enough (found_digit < half + 1) by lia.
    apply Z.div_lt_upper_bound; [lia|]. unfold dividend, half. lia. }
  assert (H3 : 0 <= root * found_digit) by (apply Z.mul_nonneg_nonneg; lia).
  assert (Hleft : 0 <= left <= 2 * root - 1) by (unfold left; lia).
  assert (H4 : 0 <= left * half <= (2 * root - 1) * half).
  { unfold half. split; [apply Z.mul_nonneg_nonneg | apply Z.mul_le_mono_nonneg_r]; lia. }
  assert (H5 : 0 <= root * half <= (half - 1) * half).
  { unfold half. split; [apply Z.mul_nonneg_nonneg | apply Z.mul_le_mono_nonneg_r]; lia. }
  assert (H6 : 0 <= found_digit * found_digit <= half * half).
  { split; [apply Z.mul_nonneg_nonneg | apply Z.mul_le_mono_nonneg]; unfold half in *; lia. }
  assert (H7 : 2 * half <= word) by (unfold word; apply Z.mul_le_mono_nonneg_r; unfold half; lia).
  assert (H8 : 2 * word <= word * word) by (apply Z.mul_le_mono_nonneg_r; unfold half in *; lia).
  assert (Hword : word = half * half) by reflexivity.
  assert (H9 : rest * h < word) by (unfold dividend in *; lia).
  assert (Hhalf : 0 < half /\ root < half /\ b < half) by (unfold half; lia).
  clearbody word half found_digit left over dividend. lia.
Qed.

(** The root of a 16-bit number with one of its two highest bits set. A table of the code has, for the highest eight bits, the
    root of the largest number with these bits. *)
Definition scaled_16 (n : Z) : Z * Z :=
  let most := Z.sqrt (256 * (n / 256) + 255) in
  let root := if n <? most * most then most - 1 else most in (root, n - root * root).

Definition scaled_32 : Z -> Z * Z := level scaled_16 256.
Definition scaled_64 : Z -> Z * Z := level scaled_32 65536.

Lemma scaled_16_is_root (n : Z) : 128 * 128 <= n < 4 * (128 * 128) -> is_root n (scaled_16 n).
Proof.
  intros H. unfold scaled_16.
  assert (D := Z.div_mod n 256 ltac:(lia)). assert (M := Z.mod_pos_bound n 256 ltac:(lia)).
  set (most := Z.sqrt (256 * (n / 256) + 255)).
  destruct (Z.sqrt_spec (256 * (n / 256) + 255) ltac:(lia)) as [low high]. fold most in low, high.
  assert (128 <= most) by (apply Z.sqrt_le_square; lia).
  destruct (Z.ltb_spec n (most * most)); unfold is_root; lia.
Qed.

Lemma scaled_32_is_root (n : Z) : 32768 * 32768 <= n < 4 * (32768 * 32768) -> is_root n (scaled_32 n).
Proof. intros H. apply (level_is_root scaled_16 128); [lia | exact scaled_16_is_root | lia]. Qed.

Lemma scaled_64_is_root (n : Z) : 2 ^ 62 <= n < 2 ^ 64 -> is_root n (scaled_64 n).
Proof. intros H. apply (level_is_root scaled_32 32768); [lia | exact scaled_32_is_root | lia]. Qed.

(** The root of any number. The number is scaled by a power of four, so its root is scaled by a power of two. *)
Definition whole_root (scaled : Z -> Z * Z) (bits n : Z) : Z :=
  if n =? 0 then 0
  else let pairs := (bits - 1 - Z.log2 n) / 2 in fst (scaled (n * 2 ^ (2 * pairs))) / 2 ^ pairs.

(** The root of a number with one of its four highest bits set. *)
Definition high_root (scaled : Z -> Z * Z) (bits n : Z) : Z :=
  if n / 2 ^ (bits - 2) =? 0 then fst (scaled (n * 4)) / 2 else fst (scaled n).

Lemma shifted (scaled : Z -> Z * Z) (pairs n : Z) :
  0 <= pairs -> 0 <= n -> is_root (n * 2 ^ (2 * pairs)) (scaled (n * 2 ^ (2 * pairs))) ->
  fst (scaled (n * 2 ^ (2 * pairs))) / 2 ^ pairs = Z.sqrt n.
Proof.
  intros Hp Hn. destruct (scaled _) as [root rest]. cbn [fst]. unfold is_root. intros [square Hrest].
  assert (P : 0 < 2 ^ pairs) by (apply Z.pow_pos_nonneg; lia).
  replace (2 ^ (2 * pairs)) with (2 ^ pairs * 2 ^ pairs) in square by (rewrite <- Z.pow_add_r by lia; f_equal; lia).
  set (one := 2 ^ pairs) in *. symmetry. apply Z.sqrt_unique. rewrite <- Z.add_1_r.
  assert (D := Z.div_mod root one ltac:(lia)). assert (M := Z.mod_pos_bound root one P).
  assert (Q : 0 <= root / one) by (apply Z.div_pos; lia). set (q := root / one) in *.
  split.
  - apply (Z.mul_le_mono_pos_r _ _ (one * one)); [nia|].
    assert (q * one * (q * one) <= root * root) by (apply Z.mul_le_mono_nonneg; nia). lia.
  - apply (Z.mul_lt_mono_pos_r (one * one)); [nia|].
    assert ((root + 1) * (root + 1) <= (q + 1) * one * ((q + 1) * one)) by (apply Z.mul_le_mono_nonneg; lia). lia.
Qed.

Lemma whole_is_sqrt (scaled : Z -> Z * Z) (bits n : Z) :
  0 <= bits -> Z.even bits = true ->
  (forall m, 2 ^ (bits - 2) <= m < 2 ^ bits -> is_root m (scaled m)) -> 0 <= n < 2 ^ bits ->
  whole_root scaled bits n = Z.sqrt n.
Proof.
  intros Hbits even Hscaled Hn. unfold whole_root. destruct (Z.eqb_spec n 0) as [->|Hn0]; [reflexivity|].
  assert (L := Z.log2_spec n ltac:(lia)). assert (L0 := Z.log2_nonneg n).
  assert (L1 : Z.log2 n < bits) by (apply Z.log2_lt_pow2; lia).
  set (l := Z.log2 n) in *. set (pairs := (bits - 1 - l) / 2).
  assert (D := Z.div_mod (bits - 1 - l) 2 ltac:(lia)). assert (M := Z.mod_pos_bound (bits - 1 - l) 2 ltac:(lia)).
  fold pairs in D. assert (P : 0 <= pairs) by (apply Z.div_pos; lia).
  apply shifted; [lia | lia |]. apply Hscaled. clear Hscaled.
  assert (0 < 2 ^ (2 * pairs)) by (apply Z.pow_pos_nonneg; lia).
  split.
  - apply Z.le_trans with (2 ^ l * 2 ^ (2 * pairs)); [|apply Z.mul_le_mono_nonneg_r; lia].
    rewrite <- Z.pow_add_r by lia. apply Z.pow_le_mono_r; lia.
  - apply Z.lt_le_trans with (2 ^ Z.succ l * 2 ^ (2 * pairs)); [apply Z.mul_lt_mono_pos_r; lia|].
    rewrite <- Z.pow_add_r by lia. apply Z.pow_le_mono_r; lia.
Qed.

Lemma high_is_sqrt (scaled : Z -> Z * Z) (bits n : Z) :
  4 <= bits -> (forall m, 2 ^ (bits - 2) <= m < 2 ^ bits -> is_root m (scaled m)) ->
  2 ^ (bits - 4) <= n < 2 ^ bits -> high_root scaled bits n = Z.sqrt n.
Proof.
  intros Hbits Hscaled Hn. unfold high_root.
  assert (Q : 2 ^ bits = 16 * 2 ^ (bits - 4)) by (rewrite <- (Z.pow_add_r 2 4) by lia; f_equal; lia).
  assert (R : 2 ^ (bits - 2) = 4 * 2 ^ (bits - 4)) by (rewrite <- (Z.pow_add_r 2 2) by lia; f_equal; lia).
  destruct (Z.eqb_spec (n / 2 ^ (bits - 2)) 0) as [small|large].
  - apply Z.div_small_iff in small; [|lia].
    exact (shifted scaled 1 n ltac:(lia) ltac:(lia) (Hscaled (n * 4) ltac:(lia))).
  - rewrite Z.div_small_iff in large by lia.
    pose proof (shifted scaled 0 n ltac:(lia) ltac:(lia)) as found. cbn in found.
    rewrite Z.mul_1_r, Z.div_1_r in found. apply found, Hscaled. lia.
Qed.

(** The shipped functions: roots of 32-bit and 64-bit numbers. *)
Definition root_32 : Z -> Z := whole_root scaled_32 32.
Definition root_high_32 : Z -> Z := high_root scaled_32 32.
Definition root_64 : Z -> Z := whole_root scaled_64 64.
Definition root_high_64 : Z -> Z := high_root scaled_64 64.

Theorem halves_are_the_root (n : Z) :
  (0 <= n < 2 ^ 32 -> root_32 n = Z.sqrt n) /\ (2 ^ 28 <= n < 2 ^ 32 -> root_high_32 n = Z.sqrt n) /\
  (0 <= n < 2 ^ 64 -> root_64 n = Z.sqrt n) /\ (2 ^ 60 <= n < 2 ^ 64 -> root_high_64 n = Z.sqrt n).
Proof.
  split; [|split; [|split]]; intros H.
  - apply whole_is_sqrt; [lia | reflexivity | exact scaled_32_is_root | exact H].
  - apply high_is_sqrt; [lia | exact scaled_32_is_root | exact H].
  - apply whole_is_sqrt; [lia | reflexivity | exact scaled_64_is_root | exact H].
  - apply high_is_sqrt; [lia | exact scaled_64_is_root | exact H].
Qed.
