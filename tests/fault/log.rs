//! What the log for programs says about each kind; the log for people stands in docs/faults.md.

use super::{READ, acme, ask, drive};
use crate::kit::object;
use drivemu::medium::FaultKind;
use serde_json::{Value, json};

#[test]
fn a_repeated_command_as_json() {
    let mut rig = acme(&["lose_reply:count=1"]);
    let row = rig.drive().model().wiring.commands[0].row;
    let [high, low] = rig.drive().model().map.row(row).at.to_be_bytes();
    (0..2).for_each(|_| drop(ask(&mut rig, &[6, high, low, 0, 4])));
    let told = object(rig.events().last().expect("an event"));
    let text = "unit 1 clear_position repeated; the first reply never arrived (#1)";
    let want = json!({"t": 0.3, "line": "line", "event": "repeated_command", "unit": 1,
        "action": "clear_position", "count": 1, "text": text});
    assert_eq!(told, want);
}

#[test]
fn each_kind_as_json() {
    for kind in FaultKind::ALL {
        let (spec, mut want) = match kind.name {
            "flip_bits" => ("flip_bits:bits=2", json!({"bits": 2})),
            "truncate" => ("truncate:bytes=3", json!({"bytes": 3})),
            "extra" => ("extra:bytes=2", json!({"bytes": 2})),
            "garbage" => ("garbage", json!({"bytes": 1})),
            "delay" => ("delay:ms=200", json!({"ms": 200.0})),
            "split" => ("split:at=3,gap_ms=50", json!({"at": 3, "gap_ms": 50})),
            "wrong_unit" => ("wrong_unit", json!({"to": 2})),
            "wrong_function" => ("wrong_function:to=6", json!({"to": 6})),
            "exception" => ("exception:code=4", json!({"code": 4})),
            "reorder" => ("reorder", json!({"ahead": false})),
            "lose_request" | "lose_reply" | "bad_crc" | "late" | "duplicate" | "busy" | "echo" => {
                (kind.name, json!({}))
            }
            _ => panic!("nobody tests `{kind}`"),
        };
        let mut rig = drive(&[spec]);
        ask(&mut rig, READ);
        let told = rig.events().iter().map(object);
        let told = told.filter(|it| it["event"] == "fault").collect::<Vec<Value>>();
        let [Value::Object(told)] = told.as_slice() else { panic!("{told:?}") };
        let common = [("rule", json!(kind.name)), ("kind", json!(kind.name))];
        let common = common.into_iter().chain([("unit", json!(1)), ("hit", json!(1))]);
        common.for_each(|(key, value)| want[key] = value);
        let own = |key: &String| !["t", "line", "event", "text"].contains(&key.as_str());
        let told: Value =
            told.iter().filter(|(key, _)| own(key)).map(|(k, v)| (k.clone(), v.clone())).collect();
        assert_eq!(told, want, "{spec}");
    }
}
