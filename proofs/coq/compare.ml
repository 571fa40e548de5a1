(* Reads ticks of the shipped guard (examples/guard_trace.rs) and runs the extracted specification on them: every memory and every
   answer must be the same, to the last bit. *)

open Guard_spec

let rec positive n = if n = 1 then XH else if n land 1 = 1 then XI (positive (n lsr 1)) else XO (positive (n lsr 1))
let z n = if n = 0 then Z0 else if n > 0 then Zpos (positive n) else Zneg (positive (-n))

let rec of_positive = function XH -> 1 | XO p -> 2 * of_positive p | XI p -> (2 * of_positive p) + 1
let int = function Z0 -> 0 | Zpos p -> of_positive p | Zneg p -> -of_positive p

let guard = ref None
let memory = ref None
let ticks = ref 0
let guards = ref 0

let fail line said = Printf.printf "after %d ticks: %s: specified %s\n" !ticks line said; exit 1

let take line =
  match String.split_on_char ' ' line with
  | "guard" :: numbers -> (
      match List.map (fun text -> z (int_of_string text)) numbers with
      | [ capacity; refill; damping; furthest; count; late; stray; slack; per_reach; in_flight; overrun ] ->
          let it = { capacity; refill; damping; furthest; count; late; stray; slack; per_reach; in_flight; overrun } in
          incr guards; guard := Some it; memory := Some (full it)
      | _ -> fail line "another number of coefficients")
  | "tick" :: numbers -> (
      match (List.map int_of_string numbers, !guard, !memory) with
      | [ moved; before; wanted; told; account'; force'; older'; fine; told' ], Some it, Some before_tick ->
          let after, answer = tick it before_tick (z moved) (z before) (z wanted) in
          let last = commanded after (z told) in
          let got = [ int after.account; int after.force; int after.older; (if answer then 1 else 0); int last.force ] in
          if got <> [ account'; force'; older'; fine; told' ] then
            fail line (String.concat " " (List.map string_of_int got));
          incr ticks; memory := Some last
      | _ -> fail line "another number of values")
  | _ -> fail line "no such line"

let () =
  (try while true do take (input_line stdin) done with End_of_file -> ());
  if !ticks = 0 then fail "nothing" "nothing was compared";
  Printf.printf "%d ticks of %d guards are the extracted specification's, bit for bit\n" !ticks !guards
