// A knob, a magnet holder and a bracket that keeps the encoder's chip at the right gap from the magnet.
//
//   openscad -D 'part="knob"' -o knob.stl docs/knob/knob.scad        (also "magnet" and "bracket")
//
// All lengths in mm. Measure your motor, magnet and encoder board first: the numbers below are examples.

part = "all";             // "knob", "magnet", "bracket" or "all"

/* [Motor: measure] */
motor_d = 35;             // outer diameter of the motor
rotor_d = 35;             // diameter of the part that turns, which carries the knob
rotor_holes_d = 12;       // circle of the rotor's screw holes
stator_holes_d = 19;      // circle of the stator's screw holes, at the motor's back
screws = 4;
screw_d = 2.7;            // for M2.5
hollow_d = 8;             // free hole through the stator, for the magnet's stem
rotor_bore_d = 5;         // hole in the rotor that takes the magnet's stem
stem_length = 18;         // from the rotor's bore to the motor's back

/* [Magnet and encoder board: measure] */
magnet_d = 6;             // magnetised across its diameter
magnet_h = 2.5;
magnet_out = 2;           // the magnet's face below the motor's back
gap = 1;                  // from the magnet's face to the chip's
chip_h = 1.2;             // the chip's face above its board
board = [28, 28];         // hole spacing is board minus twice board_edge
board_edge = 3;
board_screw_d = 2.2;      // for M2

/* [Print] */
knob_d = 45;
knob_h = 16;
wall = 3;
fit = 0.2;                // clearance between two diameters
$fn = 48;

assert(gap >= 0.5 && gap <= 2, "gap must be 0.5 to 2 mm: the chip reads no other");
assert(magnet_d + 2 <= hollow_d, "the magnet's holder must turn freely: hollow_d must exceed magnet_d by 2 mm");
assert(magnet_out + gap + chip_h < 20, "the board would hang too far below the motor");

// From the motor's back down to the encoder board's top.
board_depth = magnet_out + gap + chip_h;

module ring_of_holes(circle, d, h) {
    for (i = [0 : screws - 1])
        rotate(i * 360 / screws) translate([circle / 2, 0, -1]) cylinder(d = d + fit, h = h + 2);
}

// A cap over the rotor: 20 grooves for the fingers, screws from above.
module knob() {
    difference() {
        cylinder(d = knob_d, h = knob_h);
        translate([0, 0, -1]) cylinder(d = rotor_d + fit, h = knob_h - wall + 1);
        ring_of_holes(rotor_holes_d, screw_d, knob_h);
        for (i = [0 : 19])
            rotate(i * 18) translate([knob_d / 2 + 0.6, 0, -1]) cylinder(d = 3, h = knob_h + 2, $fn = 12);
    }
}

// A stem in the rotor's bore, with a cup for the magnet at its end.
module magnet() {
    cup_d = magnet_d + 1.4;
    difference() {
        union() {
            cylinder(d = rotor_bore_d - fit, h = stem_length + magnet_out - magnet_h);
            translate([0, 0, stem_length + magnet_out - magnet_h - 1]) cylinder(d = cup_d, h = magnet_h + 1);
        }
        translate([0, 0, stem_length + magnet_out - magnet_h]) cylinder(d = magnet_d + fit / 2, h = magnet_h + 1);
    }
}

// A plate that carries the motor by its back, on four legs; the encoder board is screwed to posts below it.
module bracket() {
    side = max(motor_d, board[0], board[1]) + 4 * wall;
    leg_h = board_depth + 14;
    posts = [board[0] / 2 - board_edge, board[1] / 2 - board_edge];
    difference() {
        union() {
            translate([-side / 2, -side / 2, 0]) cube([side, side, wall]);
            for (x = [-1, 1], y = [-1, 1]) {
                translate([x * (side / 2 - wall), y * (side / 2 - wall), 0])
                    translate([-wall, -wall, 0]) cube([2 * wall, 2 * wall, wall + leg_h]);
                // The posts start inside the plate; the motor is on the plate's other side.
                translate([x * posts[0], y * posts[1], 0]) cylinder(d = board_screw_d + 3, h = board_depth);
            }
        }
        translate([0, 0, -1]) cylinder(d = hollow_d + fit, h = wall + 2);
        ring_of_holes(stator_holes_d, screw_d, wall);
        for (x = [-1, 1], y = [-1, 1])
            translate([x * posts[0], y * posts[1], -1]) cylinder(d = board_screw_d, h = board_depth + 2);
    }
}

assert(board_depth > wall, "the board's posts would end inside the plate: raise magnet_out or lower wall");
if (part == "knob") knob();
else if (part == "magnet") magnet();
else if (part == "bracket") bracket();
else {
    knob();
    translate([45, 0, 0]) magnet();
    translate([0, 70, 0]) bracket();
}
