//! Conversations with the drives, one behaviour a file: `tests/transcripts/<model>/*.txt`.
//!
//! A line `# also: MODEL` in a file has it played with that model too.

use crate::kit::{Conversation, MODELS, play_all};
use drivemu::model::builtin::Builtin;
use drivemu::model::{Choices, OptionInfo};
use drivemu::testkit::transcript::Script;

#[test]
fn conversations_go_as_written() {
    play_all(&Conversation::all("tests/transcripts"));
}

/// Every choice of every option has a conversation that goes that way only with this choice.
#[test]
fn each_choice_of_each_option_shows() {
    let conversations = Conversation::all("tests/transcripts");
    let mut unseen = Vec::new();
    for model in MODELS {
        for option in options(model) {
            for choice in &option.choices {
                if !conversations.iter().any(|it| shows(it, model, &option, choice)) {
                    unseen.push(format!("{model}: {} {choice}", option.name));
                }
            }
        }
    }
    assert!(unseen.is_empty(), "no conversation depends on\n{}", unseen.join("\n"));
}

/// A failure has to say where, what and what happened before, or nobody can work with hundreds of files.
#[test]
fn a_failure_says_where_and_what() {
    let conversation = Conversation { path: "here.txt".into(), texts: Vec::new() };
    let text = "model hcfa-x\n\n> 06 0304 0007\n? P03.04 8\n";
    let failure = conversation.play_text(text).expect_err("7 is not 8");
    assert!(failure.starts_with("here.txt:4: (model hcfa-x) P03.04 is 7, not 8\n"), "{failure}");
    assert!(failure.contains("--- log\n") && failure.contains("jog speed = 7"), "{failure}");
}

/// Does `conversation` choose `choice`, and fail with any other?
fn shows(conversation: &Conversation, model: &str, option: &OptionInfo, choice: &str) -> bool {
    let line = format!("option {} {choice}", option.name);
    let of_model = |text: &&String| {
        let script = Script::parse(text).unwrap_or_else(|it| panic!("{}:{it}", conversation.path));
        script.drives.iter().any(|drive| drive.model == model)
    };
    let mut texts = conversation.texts.iter().filter(of_model);
    texts.any(|text| {
        let chosen = text.lines().any(|it| it.trim() == line);
        chosen
            && option.choices.iter().filter(|other| *other != choice).all(|other| {
                let other = text.replace(&line, &format!("option {} {other}", option.name));
                conversation.play_text(&other).is_err()
            })
    })
}

fn options(model: &str) -> Vec<OptionInfo> {
    let builtin = Builtin::find(model).expect("an embedded model");
    builtin.load(&Choices::new()).expect("a good model").options
}
