//! Join tokens, as people paste them.

use crate::text;
use proto::join::{Pass, Token, TokenError, TokenId};

/// A token that is read is the very text that is written for it, but for a slash behind its address; one that is
/// refused is refused in words that hold nothing of its pass, which is secret. The id of one stands for itself too.
pub fn token(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    let pass = text.split_once('#').map_or(text, |(_, pass)| pass);
    match (text.parse::<Token>(), pass.parse::<Pass>()) {
        (Ok(token), Ok(pass)) => {
            assert!(token.pass == pass, "the pass of a token is another one than its text");
            let again = token.to_string();
            assert_eq!(again, text.replacen("/#", "#", 1));
            assert!(again.parse::<Token>().is_ok_and(|again| again == token), "what was written is refused");
        }
        (Ok(_), Err(error)) => panic!("a token with a pass that is none: {error}"),
        (Err(TokenError::Form | TokenError::Address { .. }), Ok(pass)) => {
            assert!(text.ends_with(&pass.to_string()), "a pass has two texts");
        }
        (Err(_), Err(TokenError::Form | TokenError::Damaged | TokenError::Version { .. })) => {}
        (Err(error), _) => panic!("refused with more than is known: {error}"),
    }
    if let Ok(id) = text.parse::<TokenId>() {
        assert_eq!(id.to_string(), text.to_ascii_lowercase());
    }
}
