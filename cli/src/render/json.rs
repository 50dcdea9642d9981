//! Wire messages as JSON: the shapes of `--json`, which scripts rely on and `docs/cli.md` lists. Names are
//! those of the wire; nothing is left out but what does not apply.

use proto::v1;
use serde_json::{Value, json};

use super::number;

/// Text that is JSON itself, as what it says; text that is none, as a string; empty text as null.
pub(crate) fn parsed(text: &str) -> Value {
    if text.is_empty() {
        return Value::Null;
    }
    serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.to_owned()))
}

fn named(text: &str) -> Value {
    if text.is_empty() { Value::Null } else { json!(text) }
}

fn id(number: u64) -> Value {
    if number == 0 { Value::Null } else { json!(number) }
}

/// An experiment, with its runs.
pub(crate) fn experiment(of: &v1::Experiment) -> Value {
    json!({
        "id": of.id, "name": of.name, "group": named(&of.group), "system": of.system, "search": of.search,
        "state": of.state, "reason": named(&of.reason), "seed": of.seed, "runs": of.runs,
        "cell": parsed(&of.cell), "created_ms": of.created_ms, "ended_ms": of.ended_ms,
        "individuals": of.individuals, "planned": id(of.planned), "evaluated": of.evaluated,
        "culled": of.culled, "aborted": of.aborted, "failed": of.failed,
        "progress": of.progress.iter().map(run).collect::<Vec<_>>(),
    })
}

fn run(of: &v1::Run) -> Value {
    json!({
        "run": of.run, "stage": of.stage, "stage_name": named(&of.stage_name),
        "generation": of.generation, "generations": id(of.generations.into()), "done": of.done,
        "size": of.size, "best": of.best, "best_individual": id(of.best_individual),
        "finished": of.finished,
    })
}

/// A generation that has ended, as an event.
pub(crate) fn generation(experiment: u64, name: &str, of: &v1::Generation) -> Value {
    json!({
        "event": "generation", "experiment": experiment, "name": name, "run": of.run, "stage": of.stage,
        "stage_name": named(&of.stage_name), "generation": of.generation,
        "generations": id(of.generations.into()), "individuals": of.individuals,
        "completed": of.completed, "culled": of.culled, "aborted": of.aborted, "failed": of.failed,
        "inherited": of.inherited, "best": of.best, "mean": of.mean, "worst": of.worst,
        "best_individual": id(of.best_individual), "steps": of.steps, "seconds": of.seconds,
        "notes": parsed(&of.notes),
    })
}

/// A change of state, as an event.
pub(crate) fn state(of: &v1::Experiment) -> Value {
    let mut event = experiment(of);
    event["event"] = json!("state");
    event["experiment"] = json!(of.id);
    event
}

/// A report of progress, as an event.
pub(crate) fn progress(experiment: u64, name: &str, of: &v1::Progress) -> Value {
    json!({
        "event": "progress", "experiment": experiment, "name": name, "evaluated": of.evaluated,
        "planned": id(of.planned), "rate": of.rate, "workers": of.workers, "slots": of.slots,
    })
}

/// A word to people, as an event.
pub(crate) fn note(text: &str) -> Value {
    json!({ "event": "note", "text": text })
}

/// A choice at the end of a stage.
pub(crate) fn choice(of: &v1::Choice) -> Value {
    let candidate = |one: &v1::Candidate| {
        json!({
            "rank": one.rank, "individual": one.individual, "population": one.population,
            "fitness": one.fitness, "notes": parsed(&one.notes),
        })
    };
    json!({
        "run": of.run, "stage": of.stage, "stage_name": named(&of.stage_name), "picked": id(of.picked),
        "picked_by": named(&of.picked_by), "note": named(&of.note),
        "candidates": of.candidates.iter().map(candidate).collect::<Vec<_>>(),
    })
}

/// A worker.
pub(crate) fn worker(of: &v1::WorkerInfo) -> Value {
    json!({
        "id": of.id, "name": of.name, "host": of.host, "slots": of.slots, "version": of.version,
        "state": of.state, "in_flight": of.in_flight, "window": of.window, "completed": of.completed,
        "lost": of.lost, "busy_seconds": of.busy_seconds, "attached_ms": of.attached_ms,
        "heard_ms": of.heard_ms, "labels": of.labels,
    })
}

/// An individual. The genotype is there when the message holds one.
pub(crate) fn individual(of: &v1::IndividualReply) -> Value {
    json!({
        "id": of.id, "experiment": of.experiment, "experiment_name": of.experiment_name, "run": of.run,
        "stage": of.stage, "stage_name": named(&of.stage_name), "generation": of.generation,
        "index": of.index, "operator": of.operator, "status": of.status, "fitness": of.fitness,
        "fitness_bits": of.fitness.map(number::bits), "note": named(&of.note),
        "traits": parsed(&of.traits), "measures": parsed(&of.measures),
        "genotype": of.genotype.as_ref().map(genotype), "digest": number::hex(&of.digest),
        "task": parsed(&of.task), "seed": of.seed,
        "cull": of.cull.as_ref().map(|cull| json!({
            "at": cull.at, "cutoff": cull.cutoff, "control": cull.control,
        })),
        "interim": of.interim.as_ref().map(|interim| json!({
            "step": interim.step, "measure": interim.measure,
        })),
        "steps": of.steps, "parents": parents(&of.parents),
        "attempts": of.attempts.iter().map(attempt).collect::<Vec<_>>(),
        "inherits": id(of.inherits), "children": of.children,
    })
}

fn attempt(of: &v1::AttemptInfo) -> Value {
    json!({
        "number": of.number, "worker": of.worker, "fate": of.fate, "steps": of.steps,
        "seconds": of.seconds,
    })
}

fn parents(of: &[v1::ParentLink]) -> Vec<Value> {
    of.iter().map(|link| json!({ "parent": link.parent, "role": link.role })).collect()
}

/// An ancestor.
pub(crate) fn ancestor(of: &v1::Ancestor) -> Value {
    json!({
        "id": of.id, "depth": of.depth, "stage": of.stage, "generation": of.generation,
        "index": of.index, "operator": of.operator, "status": of.status, "fitness": of.fitness,
        "parents": parents(&of.parents),
    })
}

/// A lineage hash.
pub(crate) fn hash(of: &v1::ExperimentHash) -> Value {
    json!({
        "experiment": of.experiment, "name": of.name, "hash": number::hex(&of.hash),
        "individuals": of.individuals, "finished": of.finished,
    })
}

/// A problem of an experiment file.
pub(crate) fn problem(of: &v1::Problem) -> Value {
    json!({
        "key": named(&of.key), "message": of.message, "help": named(&of.help), "line": id(of.line.into()),
        "column": id(of.column.into()), "start": of.start, "end": of.end,
    })
}

/// A genotype: its payload in hexadecimal, and what the CBOR in it says.
fn genotype(of: &v1::Genotype) -> Value {
    json!({
        "system": of.system, "version": of.version, "payload": number::hex(&of.payload),
        "decoded": decoded(&of.payload),
    })
}

/// What a genotype's CBOR says. Null for a payload that is none, as the probe's random bytes are.
pub(crate) fn decoded(payload: &[u8]) -> Value {
    let mut rest = payload;
    match ciborium::from_reader::<ciborium::Value, _>(&mut rest) {
        Ok(value) if rest.is_empty() => cbor(value),
        _ => Value::Null,
    }
}

/// Integers beyond 64 bits, floats that are no numbers and bytes have no JSON of their own: they are written
/// as text.
fn cbor(value: ciborium::Value) -> Value {
    match value {
        ciborium::Value::Null => Value::Null,
        ciborium::Value::Bool(value) => json!(value),
        ciborium::Value::Integer(value) => {
            let value = i128::from(value);
            i64::try_from(value)
                .map(Value::from)
                .or_else(|_| u64::try_from(value).map(Value::from))
                .unwrap_or_else(|_| json!(value.to_string()))
        }
        ciborium::Value::Float(value) if value.is_finite() => json!(value),
        ciborium::Value::Float(value) => json!(value.to_string()),
        ciborium::Value::Text(value) => json!(value),
        ciborium::Value::Bytes(value) => json!(number::hex(&value)),
        ciborium::Value::Array(values) => values.into_iter().map(cbor).collect(),
        ciborium::Value::Map(entries) => entries
            .into_iter()
            .map(|(key, value)| {
                let key = match cbor(key) {
                    Value::String(key) => key,
                    other => other.to_string(),
                };
                (key, cbor(value))
            })
            .collect::<serde_json::Map<_, _>>()
            .into(),
        ciborium::Value::Tag(_, value) => cbor(*value),
        _ => Value::Null,
    }
}

/// A value of a query. NaN and infinities, which JSON has not, become text; bytes become hexadecimal.
pub(crate) fn value(of: &v1::Value) -> Value {
    use v1::value::Kind;
    match &of.kind {
        None => Value::Null,
        Some(Kind::Integer(value)) => json!(value),
        Some(Kind::Real(value)) if value.is_finite() => json!(value),
        Some(Kind::Real(value)) => json!(value.to_string()),
        Some(Kind::Text(value)) => json!(value),
        Some(Kind::Blob(value)) => json!(number::hex(value)),
    }
}

/// One row as an object. Where two columns share a name the later gets a number behind its own.
pub(crate) fn row(columns: &[String], values: &[v1::Value]) -> Value {
    let mut object = serde_json::Map::new();
    for (column, of) in columns.iter().zip(values) {
        let mut name = column.clone();
        let mut number = 2;
        while object.contains_key(&name) {
            name = format!("{column}_{number}");
            number += 1;
        }
        object.insert(name, value(of));
    }
    Value::Object(object)
}

#[cfg(test)]
mod tests {
    use super::*;
    use v1::value::Kind;

    #[test]
    fn a_row_keeps_every_column_although_names_repeat_and_every_bit_of_its_numbers() {
        let columns = ["a".to_owned(), "a".to_owned(), "b".to_owned()];
        let values = [Kind::Real(0.1 + 0.2), Kind::Integer(i64::MIN), Kind::Blob(vec![1, 171].into())];
        let values = values.map(|kind| v1::Value { kind: Some(kind) });
        let object = row(&columns, &values);
        assert_eq!(object.to_string(), r#"{"a":0.30000000000000004,"a_2":-9223372036854775808,"b":"01ab"}"#);
    }

    #[test]
    fn what_json_cannot_say_is_said_in_words() {
        let nan = v1::Value { kind: Some(Kind::Real(f64::NAN)) };
        assert_eq!(value(&nan), json!("NaN"));
        assert_eq!(value(&v1::Value { kind: None }), Value::Null);
    }

    #[test]
    fn a_genotype_is_shown_as_what_its_encoding_says() {
        let mut payload = Vec::new();
        let genotype = json!({"version": 1, "proteins": [{"id": 8, "enh": 32}], "beta": 1.5});
        ciborium::into_writer(&genotype, &mut payload).unwrap();
        assert_eq!(decoded(&payload), genotype);
        payload.push(0);
        assert_eq!(decoded(&payload), Value::Null, "bytes behind it make it none");
    }

    #[test]
    fn absent_things_are_null_and_json_text_is_no_string() {
        let shown =
            experiment(&v1::Experiment { id: 1, cell: r#"{"body":"arm"}"#.into(), ..Default::default() });
        assert_eq!(shown["cell"]["body"], "arm");
        assert_eq!(
            (&shown["group"], &shown["planned"], &shown["ended_ms"]),
            (&Value::Null, &Value::Null, &Value::Null)
        );
    }
}
