//! Verdicts as text: written and read here alone.

use std::fmt;
use std::str::FromStr;

use super::{GIVE_UPS, Verdict, VerdictKind};

/// [`Verdict::Several`].
const SEVERAL: &str = "solved (several)";

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.kind().name();
        match self {
            Verdict::Several => f.write_str(SEVERAL),
            Verdict::Approximate(Some(tier)) => write!(f, "{name}: {tier}"),
            Verdict::Approximate(None) => write!(f, "{name}: none"),
            Verdict::GaveUp(status) => write!(f, "{name}: {status}"),
            Verdict::Suspect(text) | Verdict::Refused(text) | Verdict::Crashed(text) => {
                write!(f, "{name}: {text}")
            }
            Verdict::Solved | Verdict::FalseClaim | Verdict::TimedOut | Verdict::OutOfMemory => {
                f.write_str(name)
            }
        }
    }
}

/// A text that is no verdict.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no verdict")]
pub struct NoVerdict(pub String);

impl FromStr for Verdict {
    type Err = NoVerdict;

    fn from_str(text: &str) -> Result<Self, NoVerdict> {
        if text == SEVERAL {
            return Ok(Verdict::Several);
        }
        let (name, details) = match text.split_once(": ") {
            Some((name, details)) => (name, Some(details)),
            None => (text, None),
        };
        let kind = VerdictKind::ALL.iter().find(|kind| kind.name() == name);
        let bare = |verdict| details.is_none().then_some(verdict);
        let read = kind.and_then(|kind| match kind {
            VerdictKind::Solved => bare(Verdict::Solved),
            VerdictKind::Approximate => match details? {
                "none" => Some(Verdict::Approximate(None)),
                tier => Some(Verdict::Approximate(Some(tier.parse().ok()?))),
            },
            VerdictKind::FalseClaim => bare(Verdict::FalseClaim),
            VerdictKind::GaveUp => {
                let status = GIVE_UPS.iter().find(|s| Some(s.as_str()) == details);
                status.copied().map(Verdict::GaveUp)
            }
            VerdictKind::Suspect => Some(Verdict::Suspect(details?.to_owned())),
            VerdictKind::Refused => Some(Verdict::Refused(details?.to_owned())),
            VerdictKind::Crashed => Some(Verdict::Crashed(details?.to_owned())),
            VerdictKind::TimedOut => bare(Verdict::TimedOut),
            VerdictKind::OutOfMemory => bare(Verdict::OutOfMemory),
        });
        read.ok_or_else(|| NoVerdict(text.to_owned()))
    }
}

impl TryFrom<String> for Verdict {
    type Error = NoVerdict;

    fn try_from(text: String) -> Result<Self, NoVerdict> {
        text.parse()
    }
}

impl From<Verdict> for String {
    fn from(verdict: Verdict) -> Self {
        verdict.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::verdict::NOT_RUN;
    use proptest::prelude::*;
    use stickslip_methods::Tier;

    /// Some of every kind.
    fn of_kind(kind: VerdictKind) -> Vec<Verdict> {
        let reasons = [
            "",
            "no",
            ": ",
            "a: b, \"c\"",
            "first\n  second\r\n",
            " gave-up: stalled ",
        ];
        let reasons = reasons.map(str::to_owned);
        let grades = [Some(Tier::High), Some(Tier::Mid), Some(Tier::Low), None];
        match kind {
            VerdictKind::Solved => vec![Verdict::Solved, Verdict::Several],
            VerdictKind::Approximate => grades.map(Verdict::Approximate).into(),
            VerdictKind::FalseClaim => vec![Verdict::FalseClaim],
            VerdictKind::GaveUp => GIVE_UPS
                .iter()
                .map(|status| Verdict::GaveUp(*status))
                .collect(),
            VerdictKind::Refused => reasons.map(Verdict::Refused).into(),
            VerdictKind::Suspect => reasons.map(Verdict::Suspect).into(),
            VerdictKind::Crashed => reasons.map(Verdict::Crashed).into(),
            VerdictKind::TimedOut => vec![Verdict::TimedOut],
            VerdictKind::OutOfMemory => vec![Verdict::OutOfMemory],
        }
    }

    #[test]
    fn what_is_written_is_read_back() {
        for kind in VerdictKind::ALL {
            for verdict in of_kind(*kind) {
                let text = verdict.to_string();
                assert!(verdict.kind() == *kind && text.starts_with(kind.name()));
                assert_eq!(text.parse(), Ok(verdict.clone()));
                // In a record it is that text, nothing else.
                let json = serde_json::to_string(&verdict).unwrap();
                assert_eq!(json, serde_json::to_string(&text).unwrap());
                assert_eq!(serde_json::from_str::<Verdict>(&json).unwrap(), verdict);
            }
        }
    }

    proptest! {
        #[test]
        fn any_reason_is_read_back(reason in any::<String>()) {
            for verdict in [Verdict::Refused(reason.clone()), Verdict::Crashed(reason.clone())] {
                prop_assert_eq!(verdict.to_string().parse(), Ok(verdict));
            }
        }
    }

    #[test]
    fn other_texts_are_no_verdicts() {
        for text in [
            "",
            "met",
            NOT_RUN,
            "solved: ",
            "solved (several): 2",
            "Solved",
            "approximate",
            "approximate: middle",
            "gave-up",
            "gave-up: converged",
            "refused",
            "crashed",
            "out-of-memory: 3 GB",
        ] {
            let error = text.parse::<Verdict>().unwrap_err();
            assert_eq!(error.to_string(), format!("`{text}` is no verdict"));
        }
    }
}
