//! No inert key: each line behaviour that a bench file can say changes what comes over the wire. Presets bring theirs.

use super::{ANSWER, Bench, MS, READ, frame, line};
use drivemu::medium::{LineBehaviour, Preset};

/// Everything that leaves in a while with two requests in it.
#[cfg(feature = "cli")]
fn conversation(line_behaviour: &str) -> Vec<super::Sent> {
    let mut bench = Bench::servo(line_behaviour);
    for _ in 0..2 {
        bench.receive(&frame(READ));
        bench.wait(500 * MS);
    }
    bench.sent
}

#[cfg(feature = "cli")]
#[test]
fn each_key_changes_what_passes() {
    let schema = drivemu::bench::raw::schema();
    let keys = |of: &str| {
        let of = schema["$defs"][of]["properties"].as_object().expect("properties");
        of.keys().cloned().collect::<Vec<_>>()
    };
    let line_behaviour = ["pacing", "chunk", "echo", "chatter"];
    assert!(
        line_behaviour
            .iter()
            .all(|line_behaviour| keys("RawBenchLine").contains(&(*line_behaviour).to_owned()))
    );
    let of_chatter = keys("RawChatter");
    for key in line_behaviour.into_iter().chain(of_chatter.iter().map(String::as_str)) {
        let (without, with) = match key {
            "pacing" => ("pacing: ideal", "pacing: line"),
            "chunk" => ("chunk: 16ms", "chunk: 8ms"),
            "echo" => ("echo: false", "echo: true"),
            "chatter" => ("echo: false", "chatter: {units: [7]}"),
            "units" => ("chatter: {units: [7]}", "chatter: {units: [8]}"),
            "every" => ("chatter: {units: [7]}", "chatter: {units: [7], every: 60ms}"),
            _ => panic!("nobody tests `{key}`"),
        };
        assert!(conversation(without) != conversation(with), "`{key}` is inert");
    }
}

#[test]
fn presets_set_line_behaviour() {
    for preset in Preset::ALL.iter().filter(|preset| !preset.line_behaviour().is_empty()) {
        let name = preset.name;
        let line =
            line(&format!("pty: auto, faults: [{{do: {name}}}], drives: [{{model: hcfa-x}}]"));
        assert_eq!(line.line_behaviour, preset.line_behaviour());
        assert_eq!(line.faults.len(), preset.rules.len());
    }
    let both = "echo: true, faults: [{do: usb_adapter}, {do: crowded_line}]";
    let both = Bench::servo(both);
    let line_behaviour = both.bus.line_behaviour();
    assert!(
        line_behaviour.echo && line_behaviour.chunk.is_some() && line_behaviour.chatter.is_some()
    );
}

/// A preset that comes while the line runs, and line behaviour that go.
#[test]
fn line_behaviour_changes_while_running() {
    let mut rig = crate::kit::rig("hcfa-x", &[], &Default::default());
    assert_eq!(rig.send(&frame(READ)), frame(ANSWER));
    rig.add_fault("usb_adapter").expect("a preset");
    assert!(rig.send(&frame(READ)).is_empty());
    assert_eq!(rig.advance(16 * MS), frame(ANSWER));
    let none = drivemu::bus::LineCommand::SetBehaviour(LineBehaviour::default());
    rig.command(none).expect("done");
    assert_eq!(rig.send(&frame(READ)), frame(ANSWER));
    let rig = crate::kit::rig("hcfa-x", &[], &Default::default());
    let mut rig = rig.with_line_behaviour(LineBehaviour { echo: true, ..LineBehaviour::default() });
    assert_eq!(rig.send(&frame(READ)), [frame(READ), frame(ANSWER)].concat());
}

/// What is told when a run begins.
#[test]
fn line_behaviour_as_text() {
    let told = |line_behaviour: &str| Bench::servo(line_behaviour).bus.line_behaviour().to_string();
    assert_eq!(told("pacing: line"), "paced replies");
    let all = "pacing: line, chunk: 16ms, echo: true, chatter: {units: [7, 8]}";
    assert_eq!(told(all), "paced replies, chunks of 16ms, echo, chatter of units 7, 8");
}
