//! The page.

use jointplay_format::number::{counted, fixed};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::key_figures::{KeyFigure, key_figures};
use crate::cell::CellReport;
use crate::cell_text::{Fact, TextTable, cell_facts, cell_tables};
use crate::violation_group::ViolationGroupReport;

const STYLE: &str = include_str!("page.css");

/// Largest number of listed violation groups.
const GROUPS: usize = 40;

/// A program with its report.
#[derive(Debug, Clone, Copy)]
pub struct PageProgram<'a> {
    /// Name of the program, such as that of its file.
    pub name: &'a str,
    /// Its text.
    pub text: &'a str,
    /// Report of its check.
    pub report: &'a CellReport,
}

/// A picture of the page.
#[derive(Debug, Clone)]
pub struct PagePicture {
    /// Caption of the picture.
    pub caption: String,
    /// The picture as SVG; it is put into the page as it is.
    pub svg: String,
}

/// Content of the page.
#[derive(Debug, Clone)]
pub struct CellPage<'a> {
    /// The program with its report.
    pub program: PageProgram<'a>,
    /// A program for comparison: the same cell before a change.
    pub before: Option<PageProgram<'a>>,
    /// The cell and its arms, side by side.
    pub cell: Vec<PagePicture>,
    /// Use of the robot and the stations over time.
    pub timing: Vec<PagePicture>,
    /// Taught stations; none without taught stations.
    pub stations: Option<PagePicture>,
    /// Version of the program that made the page.
    pub version: &'a str,
}

impl CellPage<'_> {
    /// The page as HTML.
    #[must_use]
    pub fn to_html(&self) -> String {
        let report = self.program.report;
        let title = format!("{}: {}", report.cell, self.program.name);
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (title) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    (self.head())
                    (self.comparison())
                    section {
                        h2 { "Cell" }
                        div.two { @for picture in &self.cell { (drawn(picture)) } }
                    }
                    @if !report.violations.is_empty() { (self.violations()) }
                    (self.schedule())
                    (self.margins())
                    (self.accuracy())
                    (self.basis())
                    (self.listing())
                }
            }
        };
        page.into_string()
    }

    /// Title, result and key figures.
    fn head(&self) -> Markup {
        let report = self.program.report;
        let is_in_part = report.result == "passed" && !report.not_checked.is_empty();
        let has_passed = report.result == "passed" && !is_in_part;
        html! {
            header {
                h1 { (report.cell) }
                p.muted { (report.robot) ", program " (self.program.name) }
                div.result.passed[has_passed] {
                    @if has_passed { "Check passed" }
                    @else if is_in_part { "No violations in what was checked" }
                    @else if report.result == "no_motion" { "No motion: all axes stay at home" }
                    @else { (counted(report.violations.len(), "violation")) ": not safe to run" }
                }
                @for fact in self.facts(&["not checked"]) { p.unchecked { "Not checked: " (fact.text) "." } }
                div.figures {
                    @for figure in key_figures(report) {
                        div { span { (figure.name) } b { (figure.number()) } @if figure.value.is_some() && !figure.unit.is_empty() { " " small { (figure.unit) } } }
                    }
                }
            }
        }
    }

    /// The key figures of both programs, if there are two.
    fn comparison(&self) -> Markup {
        let Some(before) = &self.before else { return html! {} };
        let rows: Vec<(KeyFigure, KeyFigure)> =
            key_figures(before.report).into_iter().zip(key_figures(self.program.report)).collect();
        html! {
            section {
                h2 { "Before and after" }
                p { "Before: " (before.name) ", after: " (self.program.name) "." }
                @if !before.report.violations.is_empty() {
                    p { (before.name) " has " (counted(before.report.violations.len(), "violation")) "; its times are those of a program that is not safe to run." }
                }
                table {
                    thead { tr { th {} th.number { "before" } th.number { "after" } th.number { "difference" } } }
                    tbody {
                        @for (before, after) in &rows {
                            tr {
                                td { (after.name) }
                                td.number { (before.to_text()) }
                                td.number { (after.to_text()) }
                                td.number { (after.difference(before)) }
                            }
                        }
                    }
                }
            }
        }
    }

    fn violations(&self) -> Markup {
        let report = self.program.report;
        let remedies = report.remedies.as_deref().unwrap_or_default();
        let shown = report.violation_groups.len().min(GROUPS);
        let left = &report.violation_groups[shown..];
        html! {
            section {
                h2 { "Violations by cause" }
                div.scroll { table {
                    thead { tr {
                        th { "violation" } th.number { "count" } th.number { "first at s" } th.number { "worst at s" } th.number { "line" } th { "phase" }
                        th { "where" }
                    } }
                    tbody { @for group in &report.violation_groups[..shown] { (violation_row(group)) } }
                } }
                @if !left.is_empty() {
                    p { "And " (counted(left.iter().map(|group| group.count).sum(), "violation")) " in " (counted(left.len(), "group")) "." }
                }
                @if !remedies.is_empty() {
                    h3 { "Remedies, each verified by a check of the program" }
                    ul { @for remedy in remedies { li { (remedy.message) } } }
                }
            }
        }
    }

    fn schedule(&self) -> Markup {
        let facts = self.facts(&["time", "throughput", "robot", "periodic", "bottleneck"]);
        html! {
            section {
                h2 { "Schedule" }
                (definitions(&facts))
                (self.table("stations"))
                @for picture in &self.timing { (drawn(picture)) }
                (self.table("segments"))
                (self.table("axes"))
            }
        }
    }

    fn margins(&self) -> Markup {
        let zones = &self.program.report.bodies_in_zones;
        html! {
            section {
                h2 { "Margins" }
                (self.table("by line"))
                (self.table("minimum distances"))
                @if !zones.is_empty() {
                    h3 { "Fixed bodies in keep-out zones, which restrict only the robot and its wafers" }
                    ul { @for one in zones { li { (one.body) " is in " (one.zone) ", " (fixed(one.depth_mm, 3)) " mm deep" } } }
                }
            }
        }
    }

    fn accuracy(&self) -> Markup {
        let labels =
            ["Cartesian lines", "blended", "compensated", "residual", "hand-off step", "stations"];
        let facts = self.facts(&labels);
        if facts.is_empty() && self.stations.is_none() {
            return html! {};
        }
        html! {
            section {
                h2 { "Accuracy" }
                (definitions(&facts))
                @if let Some(picture) = &self.stations { (drawn(picture)) }
            }
        }
    }

    /// Assumptions of the results.
    fn basis(&self) -> Markup {
        let report = self.program.report;
        html! {
            section {
                h2 { "Basis of these results" }
                (definitions(&self.facts(&["platform", "program", "checked at"])))
                ul {
                    li { "Motions are those commanded: errors of the controllers and vibrations are not modelled." }
                    li { "Deflections of arms and wafers are those at rest; links before the last and all bodies are rigid." }
                    li { "Collisions are checked between the samples too, under the assumptions that the documentation states with their proof." }
                }
                @if report.assumed.is_empty() {
                    p { "Cell and robot name no assumed values." }
                } @else {
                    h3 { "Values without a known source, as stated in the files of cell and robot" }
                    ul { @for assumed in &report.assumed { li { (assumed) } } }
                }
            }
        }
    }

    /// The program with line numbers; lines with violations are marked.
    fn listing(&self) -> Markup {
        let groups = &self.program.report.violation_groups;
        let is_violated = |line: usize| {
            groups.iter().flat_map(|group| &group.occurrences).any(|one| one.line == line)
        };
        html! {
            section {
                h2 { "Program" }
                pre { @for (index, line) in self.program.text.lines().enumerate() {
                    span.violation[is_violated(index + 1)] { i { (index + 1) } (line) }
                } }
                p.muted { "Made by jointplay " (self.version) "." }
            }
        }
    }

    fn facts(&self, labels: &[&str]) -> Vec<Fact> {
        let all = cell_facts(self.program.report, self.program.name);
        all.into_iter().filter(|fact| labels.contains(&fact.label)).collect()
    }

    /// The table whose title begins so; nothing where it has no rows.
    fn table(&self, title: &str) -> Markup {
        let all = cell_tables(self.program.report);
        all.iter().find(|table| table.title.starts_with(title)).map_or(html! {}, tabulated)
    }
}

fn drawn(picture: &PagePicture) -> Markup {
    html! {
        figure {
            (PreEscaped(&picture.svg))
            figcaption { (picture.caption) }
        }
    }
}

fn definitions(facts: &[Fact]) -> Markup {
    html! { dl { @for fact in facts { dt { (fact.label) } dd { (fact.text) } } } }
}

fn tabulated(table: &TextTable) -> Markup {
    let mut letters = table.title.chars();
    let title: String =
        letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect());
    html! {
        h3 { (title) }
        div.scroll { table {
            thead { tr { @for column in &table.columns { th.number[column.is_number] { (column.heading) } } } }
            tbody { @for row in &table.rows {
                tr { @for (cell, column) in row.iter().zip(&table.columns) { td.number[column.is_number] { (cell) } } }
            } }
        } }
    }
}

fn violation_row(group: &ViolationGroupReport) -> Markup {
    let places: Vec<String> = group
        .occurrences
        .iter()
        .take(6)
        .map(|one| {
            let station = one.station.as_ref().map_or(String::new(), |name| format!(" {name},"));
            format!("line {},{station} {}: {}", one.line, one.phase, counted(one.count, "time"))
        })
        .collect();
    html! {
        tr {
            td { b { (group.kind) } ": " (group.message) }
            td.number { (group.count) }
            td.number { (fixed(group.first_s, 3)) }
            td.number { (fixed(group.worst_s, 3)) }
            td.number { (group.line) }
            td { (group.phase) }
            td { (places.join("; ")) @if group.occurrences.len() > places.len() { "; …" } }
        }
    }
}
