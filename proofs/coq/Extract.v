(** The specification as a program: what compare.ml runs beside the shipped code's ticks, and beside what it makes of
    settings. Integers stay Coq's own, of any size. *)

From Touchstone Require Import Quotient Guard GuardSettings Laws Enhanced.
Require Import ZArith ExtrOcamlBasic.
Extraction Language OCaml.
(* By quotient_is_div. *)
Extract Inlined Constant Z.div => "quotient".
Extraction "specified.ml" quotient tick commanded switched_off full accepted tdpa_tick fba_tick outside enhanced_tick free_at.
