//! What the log for programs says about each kind; the log for people stands in docs/faults.md.

use super::{READ, acme, ask, drive};
use drivemu::log::json::object;
use drivemu::medium::FaultKind;
use serde_json::{Value, json};

#[test]
fn a_repeated_command_as_json() {
    let mut rig = acme(&["lose_reply:count=1"]);
    let row = rig.drive().model().wiring.commands[0].row;
    let [high, low] = rig.drive().model().map.row(row).at.to_be_bytes();
    (0..2).for_each(|_| drop(ask(&mut rig, &[6, high, low, 0, 4])));
    let told = object(rig.events().last().expect("an event"), "line", rig.bus());
    let text = "unit 1 clear_position repeated; the first reply never arrived (#1)";
    let want = json!({"t": 0.3, "line": "line", "event": "repeated_command", "unit": 1,
        "action": "clear_position", "count": 1, "text": text});
    assert_eq!(told, want);
}

#[test]
fn each_kind_as_json() {
    for &kind in FaultKind::ALL {
        let (spec, mut want) = match kind {
            FaultKind::FlipBits => ("flip_bits:bits=2", json!({"bits": 2})),
            FaultKind::Truncate => ("truncate:bytes=3", json!({"bytes": 3})),
            FaultKind::Extra => ("extra:bytes=2", json!({"bytes": 2})),
            FaultKind::Garbage => ("garbage", json!({"bytes": 1})),
            FaultKind::Delay => ("delay:ms=200", json!({"ms": 200.0})),
            FaultKind::Split => ("split:at=3,gap_ms=50", json!({"at": 3, "gap_ms": 50})),
            FaultKind::WrongUnit => ("wrong_unit", json!({"to": 2})),
            FaultKind::WrongFunction => ("wrong_function:to=6", json!({"to": 6})),
            FaultKind::Exception => ("exception:code=4", json!({"code": 4})),
            FaultKind::LoseRequest
            | FaultKind::LoseReply
            | FaultKind::BadCrc
            | FaultKind::Late
            | FaultKind::Duplicate
            | FaultKind::Busy
            | FaultKind::Echo => (kind.name(), json!({})),
            FaultKind::NoisyCable
            | FaultKind::SleepyDrive
            | FaultKind::UsbAdapter
            | FaultKind::CrowdedLine => continue,
        };
        let mut rig = drive(&[spec]);
        ask(&mut rig, READ);
        let told = rig.events().iter().map(|event| object(event, "line", rig.bus()));
        let told = told.filter(|it| it["event"] == "fault").collect::<Vec<Value>>();
        let [Value::Object(told)] = told.as_slice() else { panic!("{told:?}") };
        let common = [("rule", json!(kind.name())), ("kind", json!(kind.name()))];
        let common = common.into_iter().chain([("unit", json!(1)), ("hit", json!(1))]);
        common.for_each(|(key, value)| want[key] = value);
        let own = |key: &String| !["t", "line", "event", "text"].contains(&key.as_str());
        let told: Value =
            told.iter().filter(|(key, _)| own(key)).map(|(k, v)| (k.clone(), v.clone())).collect();
        assert_eq!(told, want, "{spec}");
    }
}
