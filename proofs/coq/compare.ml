(* Reads ticks of the shipped code (examples/trace.rs) and runs the extracted specification on them: every memory and every answer
   must be the same, to the last bit. *)

open Specified

let rec positive n = if n = 1 then XH else if n land 1 = 1 then XI (positive (n lsr 1)) else XO (positive (n lsr 1))
let small n = if n = 0 then Z0 else if n > 0 then Zpos (positive n) else Zneg (positive (-n))

(* Eighteen digits fit a machine's word; what is longer is put together. *)
let number text =
  let length = String.length text in
  if length <= 18 then small (int_of_string text)
  else
    let negative = text.[0] = '-' in
    let head = String.sub text 0 (length - 9) and tail = int_of_string ("1" ^ String.sub text (length - 9) 9) - 1_000_000_000 in
    let rest = small (if negative then - tail else tail) in
    Z.add (Z.mul (small (int_of_string head)) (small 1_000_000_000)) rest

type running =
  | Nothing
  | A_guard of guard * memory
  | A_tdpa of tdpa * observed
  | An_fba of fba * observed

let running = ref Nothing
let ticks = ref 0
let made = ref 0

let fail line why = Printf.printf "after %d ticks: %s: %s\n" !ticks line why; exit 1
let check line same = if same then incr ticks else fail line "the specification says otherwise"
let start it = incr made; running := it

let take line =
  match String.split_on_char ' ' line with
  | [] -> fail line "an empty line"
  | word :: texts -> (
      match (word, List.map number texts, !running) with
      | "guard", [ capacity; refill; damping; furthest; count; late; stray; slack; per_reach; in_flight; overrun ], _ ->
          let it = { capacity; refill; damping; furthest; count; late; stray; slack; per_reach; in_flight; overrun } in
          start (A_guard (it, full it))
      | "tdpa", [ t_desired; form; t_damping; t_limit ], _ ->
          start (A_tdpa ({ t_desired; exact = form <> Z0; t_damping; t_limit }, outside))
      | "fba", [ f_desired; f_damping; f_limit ], _ -> start (An_fba ({ f_desired; f_damping; f_limit }, outside))
      | "tick", [ moved; before; wanted; told; account'; force'; older'; fine; told' ], A_guard (it, m) ->
          let after, answer = tick it m moved before wanted in
          let last = commanded after told in
          check line
            (after.account = account' && after.force = force' && after.older = older'
            && answer = (fine <> Z0) && last.force = told');
          running := A_guard (it, last)
      | "law", [ e; moved; force'; energy' ], A_tdpa (it, m) ->
          let after = tdpa_tick it m e moved in
          check line (after.shown = force' && after.energy = energy');
          running := A_tdpa (it, after)
      | "law", [ e; moved; force'; energy' ], An_fba (it, m) ->
          let after = fba_tick it m e moved in
          check line (after.shown = force' && after.energy = energy');
          running := An_fba (it, after)
      | _ -> fail line "not what is written here")

let () =
  (try while true do take (input_line stdin) done with End_of_file -> ());
  if !ticks = 0 then fail "nothing" "nothing was compared";
  Printf.printf "%d ticks of %d guards and laws are the extracted specification's, bit for bit\n" !ticks !made
