(** Extracts the specification as an OCaml program. compare.ml compares it with the shipped code: ticks, and the coefficients
    computed from settings. Integers have any size and are those of Zarith; Coq's own representation, one constructor for each
    bit, takes three times as long. *)

From Touchstone Require Import Quotient Root Guard GuardSettings Laws Enhanced.
Require Import ZArith ExtrOcamlBasic ExtrOcamlZBigInt.
Extraction Language OCaml.
(* Correct by the theorem quotient_is_div. *)
Extract Inlined Constant Z.div => "quotient".
Extraction "specified.ml" quotient tick commanded switched_off full made_of tdpa_tick fba_tick outside enhanced_tick free_at
  root_by_digits root_32 root_high_32 root_64 root_high_64.
