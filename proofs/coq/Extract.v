(** The specification as a program: what compare.ml runs beside the shipped code's ticks, and beside what it makes of
    settings. Integers are of any size, and Zarith's, which Coq itself counts with: one constructor a bit takes three times as long. *)

From Touchstone Require Import Quotient Root Guard GuardSettings Laws Enhanced.
Require Import ZArith ExtrOcamlBasic ExtrOcamlZBigInt.
Extraction Language OCaml.
(* By quotient_is_div. *)
Extract Inlined Constant Z.div => "quotient".
Extraction "specified.ml" quotient tick commanded switched_off full made_of tdpa_tick fba_tick outside enhanced_tick free_at
  root_by_digits root_32 root_high_32 root_64 root_high_64.
