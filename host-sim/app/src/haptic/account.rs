//! Summary of a run on a haptic device, on the terminal or as JSON. It is printed even if the run ended with an error.

use crate::out::{json, print, say, tell};
use touchstone_control::Choice;
use touchstone_device::haptic::DataSheet;
use touchstone_device::servo::{Ending, Priority, ServoLimits, ServoReport};
use touchstone_device::{DeviceWall, WallSettings};
use touchstone_lab::scorecard::on_device::DeviceCard;
use touchstone_lab::scorecard::on_device_page;
use touchstone_report::{Block, Section};
use touchstone_sim::error::Result;

/// The data of a run on a haptic device from which its summary is made.
pub struct Account<'a> {
    pub sheet: &'a DataSheet,
    pub settings: &'a WallSettings,
    /// Source of the control law and the stiffness, as text.
    pub source: &'a str,
    /// Passivity or device limits that the wall is known to exceed; `None` if there are none.
    pub caution: Option<&'a str>,
    pub wall: &'a DeviceWall<'a>,
    pub limits: &'a ServoLimits,
    pub priority: Option<&'a Priority>,
    pub report: &'a ServoReport,
    pub card: Option<&'a DeviceCard>,
}

/// Whether real-time priority or locked memory was granted, as text.
fn words(got: &std::result::Result<(), String>) -> String {
    match got {
        Ok(()) => "yes".to_owned(),
        Err(why) => format!("no ({why})"),
    }
}

impl Account<'_> {
    fn fault(&self) -> Option<String> {
        match &self.report.ending {
            Ending::Asked => None,
            Ending::Fault(fault) => Some(fault.to_string()),
        }
    }

    fn not_released(&self) -> Option<String> {
        self.report.release.as_ref().err().map(ToString::to_string)
    }

    /// The summary as JSON for programs.
    pub fn value(&self) -> serde_json::Value {
        let report = self.report;
        let classes = report
            .lateness
            .classes()
            .map(|class| serde_json::json!({ "up_to_us": class.up_to_us, "ticks": class.ticks }));
        serde_json::json!({
            "device": self.sheet.name,
            "rate_hz": self.settings.law.rate_hz,
            "wall": {
                "law": self.settings.law.law.word(),
                "k_desired_n_per_m": self.settings.law.k_desired.to_num::<f64>(),
                "source": self.source,
                "caution": self.caution,
                "guarded": self.settings.guard.is_some(),
            },
            "ticks": report.ticks,
            "missed_ticks": report.missed_ticks,
            "late_limit_ms": 1e3 * self.limits.late_s,
            "lateness": classes.collect::<Vec<_>>(),
            "lateness_max_us": report.lateness.worst_s() * 1e6,
            "stale_ticks": report.stale_ticks,
            "saturated_ticks": report.saturated_ticks,
            "outside_ticks": report.outside_ticks,
            "force_max_n": report.force_max_n,
            "speed_max_m_per_s": report.speed_max_m_per_s,
            "guard_account_min_j": self.wall.least_account_j(),
            "real_time_priority": self.priority.map(|got| got.first.is_ok()),
            "memory_locked": self.priority.map(|got| got.locked.is_ok()),
            "fault": self.fault(),
            "release_failed": self.not_released(),
            "scorecard": self.card,
        })
    }

    /// Section of a report page: the data of the run, and how late its control periods (ticks) began.
    pub fn section(&self) -> Section {
        let report = self.report;
        let row = |name: &str, value: String| vec![name.to_owned(), value];
        let mut rows = vec![
            row(
                "Ended",
                self.fault().unwrap_or_else(|| "as asked".to_owned()),
            ),
            row(
                "Released",
                self.not_released()
                    .map_or("yes".to_owned(), |why| format!("not completely: {why}")),
            ),
            row(
                "Wall",
                format!(
                    "{} {} N/mm, {}",
                    self.settings.law.law.word(),
                    self.settings.law.k_desired.to_num::<f64>().round() / 1e3,
                    self.source
                ),
            ),
            row("Rate", format!("{} Hz", self.settings.law.rate_hz)),
            row("Ticks", report.ticks.to_string()),
            row("Missed", report.missed_ticks.to_string()),
            row("With an old position", report.stale_ticks.to_string()),
            row("Saturated", report.saturated_ticks.to_string()),
            row("Longest force", format!("{:.2} N", report.force_max_n)),
        ];
        if let Some(account) = self.wall.least_account_j() {
            rows.push(row(
                "Guard's account at least",
                format!("{:.2} mJ of 40", 1e3 * account),
            ));
        }
        let mut body = vec![Block::Table {
            caption: "The run".to_owned(),
            header: ["", "Value"].map(str::to_owned).to_vec(),
            rows,
        }];
        if self.priority.is_some() {
            body.push(Block::Table {
                caption: format!(
                    "How late ticks began: {:.0} µs at worst; more than {} ms would have ended the run",
                    report.lateness.worst_s() * 1e6,
                    1e3 * self.limits.late_s
                ),
                header: ["At most", "Ticks"].map(str::to_owned).to_vec(),
                rows: report
                    .lateness
                    .classes()
                    .map(|class| vec![end(class.up_to_us), class.ticks.to_string()])
                    .collect(),
            });
        }
        Section {
            title: "Run".to_owned(),
            body,
            folded: false,
        }
    }

    /// Prints the run's summary.
    pub fn tell(&self) -> Result<()> {
        let report = self.report;
        if json() {
            return print(format_args!("{}\n", crate::out::json_text(&self.value())));
        }
        tell!(
            "ticks     {}, {} missed, {} with an old position, {} saturated, {} outside the workspace",
            report.ticks,
            report.missed_ticks,
            report.stale_ticks,
            report.saturated_ticks,
            report.outside_ticks
        );
        tell!(
            "most      {:.2} N, {:.0} mm/s",
            report.force_max_n,
            1e3 * report.speed_max_m_per_s
        );
        if let Some(account) = self.wall.least_account_j() {
            tell!(
                "guard     at least {:.2} mJ left of 40; of ticks in time, and if damping and delay are as assumed",
                1e3 * account
            );
        }
        if let Some(got) = self.priority {
            tell!(
                "real time first among threads: {}; memory locked: {}",
                words(&got.first),
                words(&got.locked)
            );
            histogram(report, self.limits)?;
        }
        if let Some(card) = self.card {
            tell!("{}", on_device_page::text(card).trim_end());
        }
        if let Some(fault) = self.fault() {
            tell!("fault     {fault}");
        }
        tell!(
            "released  {}",
            self.not_released()
                .map_or("yes".to_owned(), |why| format!("not completely: {why}"))
        );
        Ok(())
    }
}

/// Upper limit of a histogram class, as text.
fn end(up_to_us: Option<f64>) -> String {
    up_to_us.map_or("longer".to_owned(), |us| format!("{us} µs"))
}

/// Prints a histogram of how late control periods (ticks) began: one line per class, up to the last class with an entry.
fn histogram(report: &ServoReport, limits: &ServoLimits) -> Result<()> {
    let classes: Vec<_> = report.lateness.classes().collect();
    let last = classes
        .iter()
        .rposition(|class| class.ticks > 0)
        .unwrap_or(0);
    tell!(
        "lateness  latest {:.0} µs, limit {} ms",
        report.lateness.worst_s() * 1e6,
        1e3 * limits.late_s
    );
    if crate::out::quiet() {
        return Ok(());
    }
    for class in &classes[..=last] {
        let share = class.ticks as f64 / report.ticks.max(1) as f64;
        let end = end(class.up_to_us);
        let bar = "#".repeat((40.0 * share).round() as usize);
        say!(
            "{end:>9}  {:>9}  {:>7.3} %  {bar}",
            class.ticks,
            100.0 * share
        );
    }
    Ok(())
}
