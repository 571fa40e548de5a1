//! The drive's arithmetic next to the power stage: compare values, angles, the mailbox of commands.

use crate::source::Source;
use crate::{assume, cover, property};
use fixed::types::I16F16;
use touchstone_drive::Angle;
use touchstone_drive::angle::ElectricalScale;
use touchstone_drive::current::{CurrentCommand, CurrentMode};
use touchstone_drive::modulation::Modulator;
use touchstone_drive::transform::{AlphaBeta, Dq};

fn any_value<S: Source>(s: &mut S) -> I16F16 {
    I16F16::from_bits(s.i32())
}

property! {
    /// P4: whatever voltage is asked for and whatever the bus has, each compare value leaves the shunts their time: no
    /// overflow, no panic.
    equation "top - longest <= duty <= longest"
    over "timer, voltage vector, bus voltage"
    by kissat fn p4_duties32(s) {
        let timer = Modulator { top: s.u16(), longest: s.u16() };
        assume!(s, timer.longest <= timer.top && timer.top - timer.longest <= timer.longest, "the boards' constants: a test");
        let vector = AlphaBeta { alpha: any_value(s), beta: any_value(s) };
        let bus = any_value(s);
        let duties = timer.duties(vector, bus);
        for duty in duties {
            assert_reached!(duty >= timer.top - timer.longest && duty <= timer.longest);
        }
        assert!(bus > I16F16::ONE || duties == timer.zero());
        cover!(s, duties[0] == timer.longest && duties[1] < duties[0] && bus > 5, "at the limit");
        cover!(s, bus < 0, "no bus");
    }
}
property! {
    /// P9: angles wrap: what is added is the distance, the short way, wherever the turn ends.
    equation "(a + b) - a = b"
    over "pair of angles"
    fn p9_angle16(s) {
        let (from, by) = (Angle(s.u16()), Angle(s.u16()));
        let to = from.plus(by);
        assert!(to.since(from) == by.0.cast_signed());
        assert!(to.since(by) == from.0.cast_signed());
        cover!(s, to.0 < from.0 && by.0 > 0, "over the end of the turn");
        cover!(s, to.since(from) == i16::MIN, "half a turn");
    }
}
property! {
    /// P3: sine and cosine stay within one, and the table is never left.
    equation "|sin a| <= 1, |cos a| <= 1"
    over "angle"
    fn p3_sine16(s) {
        let angle = Angle(s.u16());
        assert!(angle.sin().unsigned_abs() <= 1 << 15 && angle.cos().unsigned_abs() <= 1 << 15);
        cover!(s, angle.sin() == -32_767, "lowest");
        cover!(s, angle.sin() == 0 && angle.0 > 0, "half a turn");
    }
}
property! {
    /// P3: from counts to the electrical angle, for every motor and encoder: no panic, and count 0 is angle 0.
    equation "angle(0) = 0"
    over "pole pairs, counts of a turn, count"
    by kissat fn p3_electrical_angle64(s) {
        let scale = ElectricalScale::new(s.u8(), s.u32());
        assert!(scale.angle(0) == Angle(0));
        let angle = scale.angle(s.i64());
        cover!(s, angle.0 > 0, "turned");
    }
}
property! {
    /// P10: a command arrives as it was sent, through the words that two interrupts share.
    equation "decode(encode(c)) = c"
    over "command"
    fn p10_command_arrives32(s) {
        let command = CurrentCommand {
            tick: s.u32(),
            mode: match s.u8() % 3 {
                0 => CurrentMode::Off,
                1 => CurrentMode::Offsets,
                _ => CurrentMode::Drive,
            },
            angle: Angle(s.u16()),
            advance: s.i32(),
            current: Dq { d: any_value(s), q: any_value(s) },
        };
        assert!(CurrentCommand::from_words(&command.to_words()) == command);
        cover!(s, command.mode == CurrentMode::Drive && command.advance < 0, "on");
    }
}
property! {
    /// P10: whatever bits arrive, the bridge is on for one pattern of the mode only, and off for what is not known.
    equation "mode /= 2  =>  not Drive"
    over "five words"
    fn p10_unknown_is_off32(s) {
        let words = [s.u32(), s.u32(), s.u32(), s.u32(), s.u32()];
        let mode = CurrentCommand::from_words(&words).mode;
        assert!((mode == CurrentMode::Drive) == (words[1] >> 16 == 2));
        assert!(mode == CurrentMode::Off || words[1] >> 16 == 1 || words[1] >> 16 == 2);
        cover!(s, mode == CurrentMode::Drive, "on");
        cover!(s, mode == CurrentMode::Off && words[1] >> 16 == u32::from(u16::MAX), "unknown");
    }
}

#[cfg(all(test, not(kani)))]
mod tests {
    use touchstone_drive::hardware::{B_G431B_ESC1, IHM08M1, IHM16M1, SIMPLEFOC_MINI};

    /// What `p4_duties32` assumes of a timer; a zero voltage is within its range as well.
    #[test]
    fn p4_the_boards_are_as_assumed() {
        for board in [IHM08M1, B_G431B_ESC1, IHM16M1, SIMPLEFOC_MINI] {
            let timer = board.modulator();
            assert!(timer.longest <= timer.top && timer.top - timer.longest <= timer.longest);
            assert_reached!(timer.longest < timer.top);
        }
    }
}
