//! No inert key: each key of a rule, taken from the schema, changes what comes over the wire.

use super::{READ, WRITE, ask, drive};
use drivemu::bench::raw::schema;
use drivemu::time::Duration;

/// What comes back, piece by piece, while a master reads and writes for a while.
fn conversation(spec: &str) -> Vec<Vec<u8>> {
    let mut rig = drive(&[spec]);
    let mut heard = Vec::new();
    for i in 0..40 {
        heard.push(ask(&mut rig, if i % 3 == 0 { WRITE } else { READ }));
        heard.extend((0..10).map(|_| rig.advance(Duration::from_millis(5))));
    }
    heard
}

#[test]
fn each_key_changes_what_passes() {
    let schema = schema();
    let keys = schema["$defs"]["RawFault"]["properties"].as_object().expect("properties");
    for key in keys.keys() {
        let (without, with) = match key.as_str() {
            "do" => ("lose_reply", "busy"),
            "name" => ("late:probability=0.5", "late:probability=0.5,name=another"),
            "unit" => ("late", "late:unit=2"),
            "function" => ("late", "late:function=6"),
            "register" => ("late", "late:register=0x20-0x25"),
            "from" => ("late", "late:from=2"),
            "until" => ("late", "late:until=2"),
            "skip" => ("late", "late:skip=2"),
            "every" => ("late", "late:every=2"),
            "probability" => ("late", "late:probability=0.5"),
            "count" => ("late", "late:count=2"),
            "ms" => ("delay:ms=10", "delay:ms=5-30"),
            "code" => ("exception:code=1", "exception:code=2"),
            "bytes" => ("extra", "extra:bytes=2"),
            "bits" => ("flip_bits", "flip_bits:bits=2"),
            "at" => ("split", "split:at=1"),
            "gap_ms" => ("split", "split:gap_ms=5"),
            "to" => ("wrong_unit", "wrong_unit:to=9"),
            _ => panic!("nobody tests `{key}`"),
        };
        assert!(conversation(without) != conversation(with), "`{key}` is inert");
    }
}
