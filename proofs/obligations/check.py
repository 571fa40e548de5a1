"""Integer obligations: the nonlinear facts of P1, P2, P3, P5, P6 and P11 over the integers, in two solvers.

Each obligation must be `unsat` (no counterexample) in both, and each weakened copy `sat` in at least one and `unsat` in none:
an obligation whose assumptions contradict each other would pass the first and fail the second.

Integers have no width. That machine words are integers here is P3: no operation of the laws overflows at its width.
`model.py` ties the formulas' functions to the code, and `claims.txt` has what is asked, so that none goes or says less without that file
changing; `check.py --bless` writes it.
"""
import sys
from pathlib import Path

import cvc5.pythonic as c
import z3 as z

FAILED = []


def obligations(s):
    """(name, assumptions, claim, weakened claim or assumption list) over solver module `s`."""
    I = s.Int
    E, g, a, q, f = I("E"), I("g"), I("a"), I("q"), I("f")
    quotient = [E >= 0, a > 0, q >= 0, q * a <= E, E < q * a + a]
    yield "P1 clamp: what is left is not negative", quotient, E - q * a >= 0, (quotient[:3], E - q * a >= 0)
    yield "P1 clamp: less than the displacement is left", quotient, E - q * a < a, (quotient[:4], E - q * a < a)
    yield ("P1 clamp: the force shrinks", [*quotient, g >= 0, g * a > E], q < g, (quotient + [g >= 0], q < g))
    w, m, r = I("w"), I("m"), I("r")
    retreat = [E >= 0, w > 0, m >= 0, r >= 0, w * m + r == E, f >= 0, f <= w]
    yield "P1 enhanced: rest plus saving is the energy minus the work", retreat, r + (w - f) * m == E - f * m, (
        retreat[:4] + retreat[5:], r + (w - f) * m == E - f * m)
    yield "P1 enhanced: not negative", retreat, r + (w - f) * m >= 0, (retreat[:6], r + (w - f) * m >= 0)
    G, x, d, B = I("G"), I("x"), I("d"), 1 << 24
    floor = [G >= 0, x >= 0, d * B <= G * x, G * x < d * B + B]
    yield "P2: a scaled signal is at most the product", floor, d * B <= G * x, (floor[:2] + floor[3:], d * B <= G * x)
    # P5, in steps of one nonlinear fact each.
    F, b, t, k, D = I("F"), I("b"), I("t"), I("k"), I("D")
    P = 1 << 12
    pos = [F >= 0, b >= 0, t >= 0, k >= 0, E >= 0]
    yield "P5: f 2^b <= bound root, squared", [*pos, F <= b * t], F * F <= b * t * (b * t), (pos, F * F <= b * t * (b * t))
    u, v = I("u"), I("v")
    four = [u >= 0, v >= 0, k >= 0, E >= 0, u <= 4 * P * k, v <= E]
    yield "P5: bound^2 root^2 <= 4 P c E", four, u * v <= 4 * P * k * E, (four[:5], u * v <= 4 * P * k * E)
    # P (E + f D) + k D^2 >= 0 if (P f)^2 <= 4 P k E. Multiplied by 4k, the left side is (2kD + P f)^2 + 4kPE - (P f)^2.
    h = I("h")
    # Here `square`, `hh` and `kpe` are any numbers. The next two obligations show that they stand for a square and for products.
    square, hh, kpe = I("square"), I("hh"), I("kpe")
    yield ("P5: times 4k, a square and what the bound leaves", [square >= 0, hh <= 4 * kpe], square + 4 * kpe - hh >= 0,
           ([hh <= 4 * kpe], square + 4 * kpe - hh >= 0))
    yield "P5: a square is not negative", [], h * h >= 0, ([], h * h > 0)
    yield ("P5: the square is the energy, times 4k", [],
           (2 * k * D + h) * (2 * k * D + h) + 4 * k * P * E - h * h == 4 * k * (P * E + h * D + k * D * D),
           ([], (2 * k * D + h) * (2 * k * D + h) + 4 * k * P * E - h * h == 4 * k * (P * E + h * D - k * D * D)))
    # P6: an identity for twice the energy stored before and after a tick of the virtual mass, and the energy that is lost.
    M, kf, C, Gd, d0, d1, s0, X, fp, N0, res = (I(n) for n in "M kf C Gd d0 d1 s0 X fp N0 res".split())
    total = M + kf + C + Gd
    s1 = s0 + X - d1
    force = kf * s1 + C * (X - d1)
    residue = M * d0 + kf * (s0 + X) + C * X - fp - total * d1
    before = M * d0 * d0 + kf * s0 * s0
    after = M * d1 * d1 + kf * s1 * s1
    lost = (M * (d1 - d0) * (d1 - d0) + kf * (s1 - s0) * (s1 - s0) + 2 * Gd * d1 * d1
            + 2 * C * (X - d1) * (X - d1) + 2 * residue * d1)
    yield ("P6: storage identity of the virtual mass", [], after + 2 * fp * d1 + lost == before + 2 * force * X,
           ([], after + 2 * fp * d1 + lost - 2 * residue * d1 == before + 2 * force * X))
    # The reciprocal m of a divisor d: m d + e = K, 1 <= e <= d. The quotient of n and d equals that of (n + 1) m and K. The
    # inequalities are multiplied by d.
    n, e, K, W = I("n"), I("e"), I("K"), 1 << 32
    dm, nm, ne, qK = I("dm"), I("nm"), I("ne"), I("qK")
    room = [n >= 0, d >= 1, d < W, n < d * (W // 2), e >= 1, e <= d]
    yield ("P6 reciprocal: the error is less than one step", room, (n + 1) * e <= W * W * W // 2,
           (room[:5], (n + 1) * e <= W * W * W // 2))
    whole = [d >= 1, q >= 0, r >= 0, r < d, n == q * d + r, K >= 1, e >= 1, ne >= 1, ne <= K]
    # nm stands for (n + 1) m, with d nm = (n + 1)(K - e) and ne = (n + 1) e.
    product = [d * nm == (n + 1) * K - ne]
    yield ("P6 reciprocal: not too small", [*whole, *product], d * nm >= q * d * K, (whole[:6] + product, d * nm >= q * d * K))
    yield ("P6 reciprocal: not too large", [*whole, *product], d * nm < (q * d + d) * K,
           (whole[:7] + product, d * nm < (q * d + d) * K))
    D0 = I("total")
    yield ("P6: rounding towards zero only dissipates", [D0 > 0, q >= 0, D0 * q <= r, q * D0 + D0 > r, r >= 0],
           (r - D0 * q) * q >= 0, ([D0 > 0, q >= 0, r >= 0], (r - D0 * q) * q >= 0))
    b1, b2 = I("b1"), I("b2")
    factors = [a >= 0, b1 >= 0, q >= a, b2 >= b1]
    yield ("P11: products of smaller factors are not larger, by one factor", factors[:3], a * b1 <= q * b1,
           ([factors[0], factors[2]], a * b1 <= q * b1))
    yield ("P11: products of smaller factors are not larger, by both", [*factors, a * b1 <= q * b1], a * b1 <= q * b2,
           (factors[:3] + [a * b1 <= q * b1], a * b1 <= q * b2))
    yield ("P11: the product with the largest number", [], (W // 2 - 1) * b1 == W // 2 * b1 - b1,
           ([], (W // 2 - 1) * b1 == W // 2 * b1 + b1))
    # The power of two is a + 1 + t: the factor a is t less than the largest number below that power.
    yield ("P11: a product with what is below a power of two", [t >= 0, b1 >= 0], a * b1 <= (a + 1 + t) * b1 - b1,
           ([b1 >= 0], a * b1 <= (a + 1 + t) * b1 - b1))
    yield ("P11: the products of two parts are together that of the whole", [f == a - b1], b1 * b2 + f * b2 == a * b2,
           ([], b1 * b2 + f * b2 == a * b2))
    below = [E >= 0, a > 0, q >= 0, q * a <= E, E < q * a + a]
    yield ("P11: a quotient fits a word where the dividend is less than half a word of divisors", [*below, E < W // 2 * a], q < W // 2,
           (below, q < W // 2))
    # W / 2, the first quotient that does not fit, is q + 1 + t.
    yield ("P11: and does not where it is not: below it, so is the dividend", [a > 0, t >= 0, E < q * a + a], E < (q + 1 + t) * a,
           ([a > 0, E < q * a + a], E < (q + 1 + t) * a))
    yield ("P11: the root of less than half a double word's square fits a word", [q >= 0, q * q <= E, E < W // 2 * (W // 2)], q < W // 2,
           ([q >= 0, q * q <= E], q < W // 2))

    # P3: facts of a product that is rounded down, p P <= a b < p P + P. The model checker proves that the code rounds so. A
    # factor may be 0, so a product of factors with different signs is 0 or negative. It does not matter which of the two factors
    # is negative. The limit at the end of the format keeps the sign and never applies to a share.
    p, P = I("p"), I("P")
    floor = [P > 0, p * P <= a * b1, a * b1 < p * P + P]
    yield ("P3: a product of numbers that are not negative, rounded down, is not negative", [*floor, a >= 0, b1 >= 0], p >= 0,
           ([*floor, a >= 0], p >= 0))
    yield ("P3: nor is that of two negative ones", [*floor, a <= 0, b1 <= 0], p >= 0, ([*floor, a <= 0], p >= 0))
    yield ("P3: that of one that is and one that is not is not above 0", [*floor, a >= 0, b1 <= 0], p <= 0,
           ([*floor, a >= 0], p <= 0))
    # A share is s / P with s <= P - 1. With t = P - 1 - s the product x s is x P - x - x t; xt stands for x t.
    x, xt = I("x"), I("xt")
    share = [P > 0, p * P <= x * P - x - xt, x * P - x - xt < p * P + P]
    yield ("P3: a share of what is not negative is not more", [*share, x >= 0, xt >= 0], p <= x, ([*share, x >= 0], p <= x))
    yield ("P3: nor further from 0 of what is negative", [*share, x <= 0, xt <= 0], p >= x, ([*share, x <= 0], p >= x))
    # The same with rounding to the nearest and shares in units of 1/(2 H), with 2 H = 2^16; r stands for the product.
    H = 1 << 15
    near, nearest = [p * 2 * H <= r + H, r + H < p * 2 * H + 2 * H], r == x * 2 * H - x - xt
    yield ("P3: to the nearest, a share of what is not negative is not more", [*near, nearest, x >= 0, xt >= 0], p <= x,
           ([*near, nearest, x >= 0], p <= x))
    yield ("P3: to the nearest, nor further from 0 of what is negative", [*near, nearest, x <= 0, xt <= 0], p >= x,
           ([*near, nearest, x <= 0], p >= x))
    yield "P3: to the nearest, a share of what is not negative is not negative", [*near, r >= 0], p >= 0, (near, p >= 0)
    yield "P3: to the nearest, and of what is not above 0 not above 0", [*near, r <= 0], p <= 0, (near, p <= 0)
    yield ("P3: a product has the sign of its factors", [a >= 0, b1 >= 0], a * b1 >= 0, ([a >= 0], a * b1 >= 0))
    # h is half the number of words, 2^31. The magnitude of a word is h - t.
    yield ("P3: a product is at most that with half the words", [k >= 0, t >= 0], k * (h - t) <= k * h, ([k >= 0], k * (h - t) <= k * h))


def answer(s, assumptions, claim):
    solver = s.Solver()
    if s is z:
        solver.set("timeout", 60_000)
    else:
        solver.setOption("tlimit-per", 60_000)
    for assumption in assumptions:
        solver.add(assumption)
    solver.add(s.Not(claim))
    return str(solver.check())


CLAIMS = Path(__file__).with_name("claims.txt")


def said():
    """What is asked, in the words of one of the solvers."""
    lines = []
    for what, assumptions, claim, _ in obligations(z):
        lines += [what, *(f"    {' '.join(str(each).split())}" for each in assumptions), f"    => {' '.join(str(claim).split())}"]
    return "\n".join(lines) + "\n"


def main():
    if sys.argv[1:] == ["--bless"]:
        CLAIMS.write_text(said())
    elif not CLAIMS.exists() or said() != CLAIMS.read_text():
        FAILED.append("claims")
        why = f"is not what {CLAIMS.name} says" if CLAIMS.exists() else f"was never committed: there is no {CLAIMS.name}"
        print(f"FAIL what is asked {why}; `check.py --bless` and look at what changed")
    seen = {}
    for s, name in ((z, "z3"), (c, "cvc5")):
        for what, assumptions, claim, (weak, weak_claim) in obligations(s):
            row = seen.setdefault(what, {})
            row[name] = answer(s, assumptions, claim), answer(s, weak, weak_claim)
    for what, row in seen.items():
        strong = [row[name][0] for name in ("z3", "cvc5")]
        weak = [row[name][1] for name in ("z3", "cvc5")]
        good = all(a == "unsat" for a in strong) and "sat" in weak and "unsat" not in weak
        if not good:
            FAILED.append(what)
        print(f"{'ok  ' if good else 'FAIL'} {what}: z3 {strong[0]}, cvc5 {strong[1]}; weakened: z3 {weak[0]}, cvc5 {weak[1]}")
    print(f"{len(seen) - len(FAILED)} of {len(seen)} obligations hold in both solvers")
    import model
    if not model.agrees():
        FAILED.append("model")
    sys.exit(bool(FAILED))


if __name__ == "__main__":
    main()
