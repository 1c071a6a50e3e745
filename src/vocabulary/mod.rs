//! The words that models and behaviours share: causes, signals, quantities, actions, alarms.
//!
//! Rust speaks causes, YAML speaks numbers. A model says which number, bit or row stands for which
//! word; a behaviour knows only the word. `docs/roles.md` is generated from the tables in here.

mod action;
mod cause;
mod motion;
mod number;
mod signal;

pub use action::{Action, Modifier, Modifiers};
pub use cause::{AlarmCause, AlarmCauses, Cause, Detail, Refusal, RowId};
pub use motion::{
    Condition, HomeEnd, HomeStarter, HomingStep, IndexRule, InhibitRule, InterruptRule, Lasts,
    LimitRule, LimitSource, LimitStop, MOST_STEPS, Method, OriginPosition, OriginStop, Pace,
    SignalEdge, SoftLimitRule, Steps, Target, Then, Until,
};
pub use number::{Quantity, Setting, Taken, Threshold};
pub use signal::{Input, Inputs, Output, Outputs};

/// A word with a name in files and a line of explanation: what the catalogue prints.
pub trait Named: Copy + 'static {
    /// Every word of this kind, in the order of the catalogue.
    const ALL: &'static [Self];

    /// The name in files.
    fn name(self) -> &'static str;

    /// What it means, in one line.
    fn about(self) -> &'static str;

    /// The word with that name.
    fn parse(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|word| word.name() == name)
    }
}

/// Declares an enum of words: variant, name in files, explanation.
macro_rules! named_terms {
    ($(#[$doc:meta])* $type:ident { $($variant:ident $name:literal $about:literal,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum $type {
            $(#[doc = $about] $variant,)*
        }

        impl $crate::vocabulary::Named for $type {
            const ALL: &'static [Self] = &[$(Self::$variant,)*];

            fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            fn about(self) -> &'static str {
                match self { $(Self::$variant => $about,)* }
            }
        }

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                to.serialize_str($crate::vocabulary::Named::name(*self))
            }
        }

        #[cfg(feature = "cli")]
        impl schemars::JsonSchema for $type {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($type).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({ "type": "string", "enum": [$($name),*] })
            }
        }
    };
}
pub(crate) use named_terms;
