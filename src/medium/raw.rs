//! A fault rule as it is written: the reference of the format, in bench files and on the command line.

use super::{FaultKind, LineBehaviour, Preset};
use serde::de::{EnumAccess, Error, IgnoredAny, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::sync::LazyLock;

#[cfg(feature = "cli")]
use {
    schemars::{JsonSchema, Schema, SchemaGenerator, json_schema},
    serde_json::json,
    std::borrow::Cow,
};

/// A fault rule. Of all rules of a line that match a request, the first acts.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema))]
pub struct RawFault {
    /// Name in the log; the random draws depend on it and on the seed. Default: the kind, with a number appended where
    /// that is already used.
    pub name: Option<String>,
    /// The kind of fault, or a preset.
    #[serde(rename = "do")]
    pub act: RawAct,
    /// Only requests to this unit; 0 is a broadcast.
    pub unit: Option<u8>,
    /// Only requests with this function code, or with one of a list.
    pub function: Option<RawFunctions>,
    /// Only requests that access this address, this address range, or this register.
    pub register: Option<RawFaultRegister>,
    /// Only from this emulated time on, in seconds.
    pub from: Option<f64>,
    /// Only before this emulated time, in seconds.
    pub until: Option<f64>,
    /// Let this many requests pass first.
    pub skip: Option<u64>,
    /// Then act on every Nth: 2 is the 2nd, the 4th ... Default 1.
    pub every: Option<u64>,
    /// Act with this probability, above 0 and at most 1; default: always.
    pub probability: Option<f64>,
    /// Act this many times and no more.
    pub count: Option<u64>,
    /// The keys that its kind has of its own.
    #[serde(flatten)]
    pub own: OwnKeys,
}

/// What a rule does: a kind of fault, or a preset.
#[derive(Debug, Clone, Copy)]
pub enum RawAct {
    /// A kind.
    Kind(&'static FaultKind),
    /// A preset.
    Preset(&'static Preset),
}

/// The keys that a kind has of its own. What they say is read out of the tree, as their kind wants it.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct OwnKeys(pub BTreeMap<String, IgnoredAny>);

/// One function code, or several.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawFunctions {
    /// One.
    #[serde(rename = "a number from 1 to 127")]
    One(u8),
    /// Several.
    #[serde(rename = "a list of numbers")]
    Many(Vec<u8>),
}

/// Registers.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "cli", derive(JsonSchema), schemars(untagged))]
pub enum RawFaultRegister {
    /// One address.
    #[serde(rename = "a number (an address)")]
    Address(u16),
    /// A span, or the name of a row.
    #[serde(rename = "a string (a span such as 0x20-0x25, or a name)")]
    Name(String),
}

/// The keys that a rule of any kind has.
pub(super) const COMMON_KEYS: &[&str] = &[
    "count",
    "do",
    "every",
    "from",
    "function",
    "name",
    "probability",
    "register",
    "skip",
    "unit",
    "until",
];

/// What a rule can do, by name.
static NAMES: LazyLock<Vec<&str>> = LazyLock::new(|| {
    let kinds = FaultKind::ALL.iter().map(|kind| kind.name);
    kinds.chain(Preset::ALL.iter().map(|preset| preset.name)).collect()
});

impl RawAct {
    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kind(kind) => kind.name,
            Self::Preset(preset) => preset.name,
        }
    }

    /// Why it is impossible on Modbus TCP, if it is.
    pub fn impossible_on_tcp(self) -> Option<&'static str> {
        match self {
            Self::Kind(kind) => kind.impossible_on_tcp,
            Self::Preset(preset) => preset.impossible_on_tcp,
        }
    }

    /// Does it also act on requests to unit 0, which have no reply?
    pub fn takes_broadcasts(self) -> bool {
        matches!(self, Self::Kind(kind) if kind.takes_broadcasts)
    }

    /// Has it a key of its own that is called `name`?
    pub fn has_key(self, name: &str) -> bool {
        matches!(self, Self::Kind(kind) if kind.key(name).is_some())
    }

    /// The line behaviour that it brings.
    pub fn line_behaviour(self) -> LineBehaviour {
        match self {
            Self::Kind(_) => LineBehaviour::default(),
            Self::Preset(preset) => preset.line_behaviour(),
        }
    }
}

impl PartialEq for RawAct {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl<'de> Deserialize<'de> for RawAct {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_enum("RawAct", &NAMES, ActVisitor)
    }
}

/// Takes one of [`NAMES`].
struct ActVisitor;

impl<'de> Visitor<'de> for ActVisitor {
    type Value = RawAct;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("kind")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<RawAct, A::Error> {
        let (name, variant) = access.variant::<String>()?;
        variant.unit_variant()?;
        let kind = FaultKind::find(&name).map(RawAct::Kind);
        let act = kind.or_else(|| Preset::find(&name).map(RawAct::Preset));
        act.ok_or_else(|| A::Error::unknown_variant(&name, &NAMES))
    }
}

#[cfg(feature = "cli")]
impl JsonSchema for RawAct {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "RawAct".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let kinds = FaultKind::ALL.iter().map(|kind| (kind.name, kind.about));
        let presets = Preset::ALL.iter().map(|preset| (preset.name, preset.about));
        let one = |(name, about)| json!({"const": name, "type": "string", "description": about});
        let all: Vec<_> = kinds.chain(presets).map(one).collect();
        json_schema!({"oneOf": all})
    }
}

#[cfg(feature = "cli")]
impl JsonSchema for OwnKeys {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "OwnKeys".into()
    }

    /// Every key of every kind. One that several kinds have accepts what any of them does.
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut properties = serde_json::Map::new();
        for name in FaultKind::ALL.iter().flat_map(|kind| kind.keys).map(|key| key.name) {
            let of = |kind: &'static FaultKind| Some((kind.name, kind.key(name)?));
            let own: Vec<_> = FaultKind::ALL.iter().filter_map(of).collect();
            let about: Vec<_> =
                own.iter().map(|(kind, key)| format!("`{kind}`: {}.", key.about)).collect();
            let mut forms: Vec<_> = own.iter().map(|(_, key)| key.form.schema()).collect();
            forms.dedup();
            let schema = json!({"description": about.join(" "), "anyOf": forms});
            properties.insert(name.into(), schema);
        }
        json_schema!({"type": "object", "properties": properties})
    }
}
