//! An experiment on its way, from the events of a watch: bars on a terminal, one line a generation otherwise,
//! one object a line with `--json`. It never asks; it shows what it is told.

use std::collections::BTreeMap;
use std::time::Duration;

use indicatif::{HumanDuration, MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use proto::v1;
use proto::v1::watch_event::What;

use super::{Output, json, number};
use crate::exit::Failure;

/// The states of the experiments watched, as far as told, and where they are shown.
#[derive(Debug)]
pub(crate) struct Progress {
    output: Output,
    bars: Option<Bars>,
    experiments: BTreeMap<u64, v1::Experiment>,
}

impl Progress {
    /// Nothing watched yet.
    pub(crate) fn new(output: Output) -> Self {
        Progress { output, bars: output.has_bars().then(Bars::new), experiments: BTreeMap::new() }
    }

    /// The experiments watched, as last told, in order of number.
    pub(crate) fn experiments(&self) -> impl Iterator<Item = &v1::Experiment> {
        self.experiments.values()
    }

    /// Shows one event.
    pub(crate) fn show(&mut self, event: &v1::WatchEvent) -> Result<(), Failure> {
        let Some(what) = &event.what else { return Ok(()) };
        let name = self.name(event.experiment);
        if self.output.json {
            return self.output.object(&match what {
                What::State(state) => {
                    self.experiments.insert(state.id, state.clone());
                    json::state(state)
                }
                What::Generation(generation) => json::generation(event.experiment, &name, generation),
                What::Progress(progress) => json::progress(event.experiment, &name, progress),
            });
        }
        match what {
            What::State(state) => {
                let before = self.experiments.insert(state.id, state.clone());
                let is_news =
                    before.is_none_or(|b| (b.state, b.reason) != (state.state.clone(), state.reason.clone()));
                if is_news {
                    self.say(&state_line(state))?;
                }
                if let Some(bars) = &mut self.bars {
                    bars.state(state);
                }
            }
            What::Generation(generation) => match &mut self.bars {
                Some(bars) => bars.generation(event.experiment, &name, generation),
                None => self.output.line(generation_line(&name, generation))?,
            },
            What::Progress(progress) => {
                if let Some(bars) = &mut self.bars {
                    bars.progress(event.experiment, &name, progress);
                }
            }
        }
        Ok(())
    }

    /// A word beside the bars; with `--json` an event of its own.
    pub(crate) fn say(&self, text: &str) -> Result<(), Failure> {
        match &self.bars {
            Some(bars) => Ok(bars.all.println(text)?),
            None if self.output.json => self.output.object(&json::note(text)),
            None => self.output.line(text),
        }
    }

    /// Takes the bars away; what comes after is print.
    pub(crate) fn end(&mut self) {
        if let Some(bars) = self.bars.take() {
            // A terminal that cannot be cleared keeps its bars; nothing depends on it.
            let _ = bars.all.clear();
        }
    }

    fn name(&self, experiment: u64) -> String {
        self.experiments.get(&experiment).map_or_else(|| experiment.to_string(), |e| e.name.clone())
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end();
    }
}

fn state_line(of: &v1::Experiment) -> String {
    let mut line = format!("{} (experiment {}): {}", of.name, of.id, of.state);
    if of.evaluated > 0 && of.state == "running" {
        line.push_str(&format!(", {} evaluated before", number::count(of.evaluated)));
    }
    if !of.reason.is_empty() {
        line.push_str(&format!(": {}", of.reason));
    }
    line
}

fn generation_line(name: &str, of: &v1::Generation) -> String {
    let mut line = format!("{name} run {}", of.run);
    line.push_str(&format!(" {}", position_in(of)));
    line.push_str(&format!(
        " best {} mean {} worst {}",
        number::figure(of.best),
        number::figure(of.mean),
        number::figure(of.worst)
    ));
    for (count, word) in [(of.culled, "culled"), (of.aborted, "aborted"), (of.failed, "failed")] {
        if count > 0 {
            line.push_str(&format!(" {word} {count}"));
        }
    }
    if of.best_individual > 0 {
        line.push_str(&format!(" by #{}", of.best_individual));
    }
    let notes = notes(&of.notes);
    if !notes.is_empty() {
        line.push_str(&format!("; {notes}"));
    }
    line
}

/// `left_turn 12/80`, or `generation 12/80` where the stage has no name.
fn position_in(of: &v1::Generation) -> String {
    let stage = if of.stage_name.is_empty() { "generation" } else { &of.stage_name };
    format!("{stage} {}", position(of.generation, of.generations))
}

/// The numbers that the search notes of a generation (flyers F-70), by their names in the lineage: the `notes`
/// of `v_generations`. What is no number is left to those who ask there.
fn notes(json: &str) -> String {
    let all: serde_json::Map<String, serde_json::Value> = serde_json::from_str(json).unwrap_or_default();
    let numbers = all.iter().filter_map(|(name, value)| Some((name, value.as_f64()?)));
    numbers.map(|(name, value)| format!("{name} {}", short(value))).collect::<Vec<_>>().join(" ")
}

/// At most three decimals, and none that say nothing.
fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    match text.trim_end_matches('0').trim_end_matches('.') {
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}

fn position(number: u32, of: u32) -> String {
    if of == 0 { number.to_string() } else { format!("{number}/{of}") }
}

/// One bar an experiment, made when it first moves.
#[derive(Debug)]
struct Bars {
    all: MultiProgress,
    each: BTreeMap<u64, Bar>,
}

#[derive(Debug)]
struct Bar {
    drawn: ProgressBar,
    stage: u32,
    generation: String,
    best: Option<f64>,
    fleet: String,
    /// Until the end, where both plan and pace are known.
    left: Option<Duration>,
}

impl Bars {
    fn new() -> Self {
        let all = MultiProgress::with_draw_target(ProgressDrawTarget::stderr_with_hz(8));
        Bars { all, each: BTreeMap::new() }
    }

    fn bar(&mut self, experiment: u64, name: &str) -> &mut Bar {
        self.each.entry(experiment).or_insert_with(|| {
            let drawn = self.all.add(ProgressBar::no_length().with_prefix(name.to_owned()));
            drawn.set_style(style("{prefix} {spinner} {pos} {wide_msg}"));
            drawn.enable_steady_tick(Duration::from_millis(250));
            Bar { drawn, stage: 0, generation: String::new(), best: None, fleet: String::new(), left: None }
        })
    }

    fn state(&mut self, of: &v1::Experiment) {
        match of.state.as_str() {
            "running" => {
                let bar = self.bar(of.id, &of.name);
                bar.length(of.planned);
                bar.drawn.set_position(of.evaluated);
                bar.stage = of.progress.iter().map(|run| run.stage).max().unwrap_or(0);
                let best = of.progress.iter().filter(|run| run.stage == bar.stage).filter_map(|run| run.best);
                bar.best = best.fold(bar.best, |best, next| Some(best.map_or(next, |b: f64| b.max(next))));
                bar.draw();
            }
            "paused" => {
                let bar = self.bar(of.id, &of.name);
                bar.fleet = format!("paused {}", of.reason);
                bar.draw();
            }
            _ => {
                if let Some(bar) = self.each.remove(&of.id) {
                    bar.drawn.finish_and_clear();
                }
            }
        }
    }

    fn generation(&mut self, experiment: u64, name: &str, of: &v1::Generation) {
        let bar = self.bar(experiment, name);
        bar.generation = format!("run {} {}", of.run, position_in(of));
        if bar.stage != of.stage {
            (bar.stage, bar.best) = (of.stage, None); // the fitness of different stages does not compare
        }
        bar.best = Some(bar.best.map_or(of.best, |best| best.max(of.best)));
        bar.draw();
    }

    fn progress(&mut self, experiment: u64, name: &str, of: &v1::Progress) {
        let bar = self.bar(experiment, name);
        bar.length(of.planned);
        bar.drawn.set_position(of.evaluated);
        bar.fleet = match of.workers {
            0 => "no worker".to_owned(),
            1 => format!("{:.0}/s, 1 worker", of.rate),
            workers => format!("{:.0}/s, {workers} workers", of.rate),
        };
        // At the pace of this sitting: the bar itself would count what was done before into it.
        let left = of.planned.saturating_sub(of.evaluated) as f64 / of.rate;
        bar.left = Duration::try_from_secs_f64(left).ok().filter(|left| !left.is_zero());
        bar.draw();
    }
}

impl Bar {
    fn length(&self, planned: u64) {
        if planned > 0 && self.drawn.length() != Some(planned) {
            self.drawn.set_length(planned);
            // The bar takes what the words leave of the terminal's width.
            self.drawn.set_style(style("{prefix} {wide_bar} {pos}/{len} {msg}"));
        }
    }

    fn draw(&self) {
        let best = self.best.map(|best| format!("best {}", number::figure(best)));
        let left = self.left.map(|left| format!("{:#}", HumanDuration(left)));
        let parts =
            [self.generation.clone(), best.unwrap_or_default(), self.fleet.clone(), left.unwrap_or_default()];
        let parts: Vec<_> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        self.drawn.set_message(parts.join("  "));
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the templates are literals; a test draws each")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn generation() -> v1::Generation {
        v1::Generation {
            run: 2,
            generation: 12,
            generations: 40,
            best: 61.2,
            mean: 30.125,
            culled: 3,
            best_individual: 4711,
            ..Default::default()
        }
    }

    #[test]
    fn a_generation_is_one_line_that_leaves_out_what_did_not_happen() {
        assert_eq!(
            generation_line("crawler-grn", &generation()),
            "crawler-grn run 2 generation 12/40 best 61.2000 mean 30.1250 worst 0.0000 culled 3 by #4711"
        );
        let endless = v1::Generation { generations: 0, stage_name: "reach".into(), ..generation() };
        assert!(generation_line("a", &endless).starts_with("a run 2 reach 12 best"));
    }

    #[test]
    fn a_generation_tells_the_numbers_that_its_search_noted() {
        let notes = r#"{"best_span":50.4992,"median":483.0,"best_flap_frequency":0.17730,"stage":"reach","kept":[1]}"#;
        let line = generation_line("flyers", &v1::Generation { notes: notes.into(), ..generation() });
        assert!(line.ends_with(" by #4711; best_flap_frequency 0.177 best_span 50.499 median 483"), "{line}");
        assert_eq!(
            generation_line("a", &v1::Generation { notes: "{}".into(), ..generation() }),
            generation_line("a", &generation())
        );
        assert_eq!([short(0.0), short(-1500.0), short(-1e-9)], ["0", "-1500", "0"]);
    }

    #[test]
    fn a_bar_draws_itself_with_and_without_a_length() {
        let mut bars = Bars::new();
        bars.generation(1, "crawler", &generation());
        bars.progress(
            1,
            "crawler",
            &v1::Progress { evaluated: 7, workers: 1, rate: 3.4, ..Default::default() },
        );
        assert_eq!(bars.each[&1].drawn.length(), None);
        assert_eq!(bars.each[&1].drawn.message(), "run 2 generation 12/40  best 61.2000  3/s, 1 worker");
        let later = v1::Progress { evaluated: 10, planned: 80, rate: 0.5, workers: 2, ..Default::default() };
        bars.progress(1, "crawler", &later);
        assert_eq!(bars.each[&1].drawn.length(), Some(80));
        assert_eq!(bars.each[&1].drawn.message(), "run 2 generation 12/40  best 61.2000  0/s, 2 workers  2m");
        bars.state(&v1::Experiment { id: 1, state: "finished".into(), ..Default::default() });
        assert!(bars.each.is_empty());
    }

    #[test]
    fn a_bar_begins_at_what_is_done() {
        let mut bars = Bars::new();
        let resumed = v1::Experiment {
            id: 1,
            name: "a".into(),
            state: "running".into(),
            evaluated: 60,
            planned: 80,
            ..Default::default()
        };
        bars.state(&resumed);
        assert_eq!((bars.each[&1].drawn.position(), bars.each[&1].drawn.length()), (60, Some(80)));
    }

    #[test]
    fn a_reason_why_nothing_moves_is_said() {
        let stuck = v1::Experiment {
            id: 3,
            name: "a".into(),
            state: "running".into(),
            reason: "disk full".into(),
            ..Default::default()
        };
        assert_eq!(state_line(&stuck), "a (experiment 3): running: disk full");
    }
}
