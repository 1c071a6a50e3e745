//! What several tests share: transcript files and how they are played, and lines with drives on them.

use crate::expect::{files, read, root};
use drivemu::bench::{BenchLine, BuiltinLibrary, Device, DeviceSpec, Library, LineBuilder, parse};
use drivemu::bus::Output;
use drivemu::event::{Event, EventKind};
use drivemu::model::builtin::Builtin;
use drivemu::model::{Choices, Model, load};
use drivemu::testkit::{Rig, transcript};
use drivemu::vocabulary::Refusal;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// A file with a conversation.
pub struct Conversation {
    /// Where it lies, from the package's root.
    pub path: String,
    /// The text, for each model that it must hold for.
    pub texts: Vec<String>,
}

impl Conversation {
    /// Every `.txt` file below `folder`, by path.
    pub fn all(folder: &str) -> Vec<Self> {
        let paths = files(folder, "txt");
        assert!(!paths.is_empty(), "no transcript in {folder}");
        paths.iter().map(|path| Self::read(path)).collect()
    }

    fn read(path: &Path) -> Self {
        let text = read(path);
        let path = path.strip_prefix(root("")).expect("below the root").display().to_string();
        let mut texts = vec![text.clone()];
        for line in text.lines() {
            if let Some(models) = line.strip_prefix("# also: ") {
                texts.extend(models.split_whitespace().map(|model| with_model(&text, model)));
            }
        }
        Self { path, texts }
    }

    /// Plays it with every model; the message says where and what.
    pub fn play(&self) -> Result<(), String> {
        self.texts.iter().try_for_each(|text| self.play_text(text).map(|_| ()))
    }

    /// Plays it with every model, and gives back the lines as they are then.
    #[cfg(feature = "cli")]
    pub fn rigs(&self) -> impl Iterator<Item = Result<Rig, String>> {
        self.texts.iter().map(|text| self.play_text(text))
    }

    /// Plays `text`, which is a variation of this conversation.
    pub fn play_text(&self, text: &str) -> Result<Rig, String> {
        transcript::run(text, &Files).map_err(|failure| {
            let model = text.lines().find(|line| line.starts_with("model ")).unwrap_or_default();
            format!("{}:{}: ({model}) {}", self.path, failure.line, failure.what)
        })
    }
}

/// Plays all of them and tells of all that fail.
pub fn play_all(conversations: &[Conversation]) {
    let failures: Vec<_> = conversations.iter().filter_map(|it| it.play().err()).collect();
    assert!(failures.is_empty(), "{} failed\n\n{}", failures.len(), failures.join("\n\n"));
}

/// The same conversation with another model: lines keep their numbers.
fn with_model(text: &str, model: &str) -> String {
    let mut swapped = String::new();
    for line in text.lines() {
        let rest = line.strip_prefix("model ").map(|rest| rest.split_once(' '));
        match rest {
            Some(Some((_, rest))) => writeln!(swapped, "model {model} {rest}"),
            Some(None) => writeln!(swapped, "model {model}"),
            None => writeln!(swapped, "{line}"),
        }
        .expect("a string takes everything");
    }
    swapped
}

/// The embedded models, and those of `tests/models`, by file name.
pub struct Files;

impl Library for Files {
    fn fetch(&self, name: &str) -> Result<(String, String), String> {
        if !name.ends_with(".yaml") {
            return BuiltinLibrary.fetch(name);
        }
        Ok((name.to_owned(), read(&root("tests/models").join(name))))
    }

    fn model(&self, name: &str, choices: &Choices) -> Result<Arc<Model>, String> {
        let (file, text) = self.fetch(name)?;
        compiled(&text, choices).map_err(|what| format!("{file}: {what}"))
    }
}

/// The names of the embedded models.
pub const MODELS: [&str; 4] = ["hcfa-x", "k-series", "yako-closed-loop", "yako-open-loop"];

/// A line with one drive of an embedded model, its options chosen.
pub fn rig(model: &str, options: &[(&str, &str)], spec: &DeviceSpec) -> Rig {
    rig_of(text_of(model), options, spec)
}

/// The text of an embedded model.
pub fn text_of(model: &str) -> &'static str {
    Builtin::all().find(|it| it.stem() == model).expect("an embedded model").text
}

/// A line with one drive of the model in `text`.
pub fn rig_of(text: &str, options: &[(&str, &str)], spec: &DeviceSpec) -> Rig {
    Rig::line(line_of(text, options, spec))
}

/// The same, not switched on.
pub fn line_of(text: &str, options: &[(&str, &str)], spec: &DeviceSpec) -> BenchLine {
    let own = |(name, choice): &(&str, &str)| ((*name).to_owned(), (*choice).to_owned());
    let choices = options.iter().map(own).collect();
    let model = compiled(text, &choices).unwrap_or_else(|problem| panic!("{problem}"));
    let device = Device::new(model, spec);
    let device = device.unwrap_or_else(|problems| panic!("{}", problems[0].what));
    LineBuilder::new("line", vec![device]).build_unmatched()
}

/// The model in `text`, compiled once for all tests that ask for it: that takes far longer than they do.
fn compiled(text: &str, choices: &Choices) -> Result<Arc<Model>, String> {
    type Compiled = BTreeMap<(String, Choices), Arc<Model>>;
    static COMPILED: Mutex<Compiled> = Mutex::new(Compiled::new());
    let key = (text.to_owned(), choices.clone());
    let known = || COMPILED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(model) = known().get(&key) {
        return Ok(model.clone());
    }
    let model = Arc::new(load(text, choices).map_err(|problems| problems[0].to_string())?);
    known().insert(key, model.clone());
    Ok(model)
}

/// The first line of a bench, for as many drives as a test wants to switch on anew.
pub fn bench_line(text: &str) -> BenchLine {
    let bench = parse(text, &BuiltinLibrary).unwrap_or_else(|problems| panic!("{}", problems[0]));
    bench.lines.into_iter().next().expect("a line")
}

/// The refusal of the last transaction, if it was one.
pub fn last_refusal(rig: &Rig) -> Option<Refusal> {
    match rig.events().iter().rev().find_map(transaction) {
        Some(refusal) => refusal,
        None => panic!("no transaction in\n{}", rig.log()),
    }
}

fn transaction(event: &Event) -> Option<Option<Refusal>> {
    match &event.kind {
        EventKind::Transaction(it) => Some(it.refusal),
        _ => None,
    }
}

/// Everything that a bus has to give away: bytes sent, events, and whether it closed the link.
#[derive(Debug, Default)]
pub struct Drained {
    pub sent: Vec<u8>,
    pub events: Vec<Event>,
    pub closed: bool,
}

/// Takes all of it.
pub fn drain(bus: &mut drivemu::bus::Bus) -> Drained {
    let mut drained = Drained::default();
    while let Some(output) = bus.poll_output() {
        match output {
            Output::Transmit { frame, .. } => drained.sent.extend_from_slice(&frame),
            Output::Event(event) => drained.events.push(event),
            other => drained.closed |= matches!(other, Output::Close(_)),
        }
    }
    drained
}

/// What programs read of an event.
#[cfg(feature = "cli")]
pub fn object(event: &Event) -> serde_json::Value {
    serde_json::from_str(&drivemu::log::json(event, "line")).expect("an object")
}
