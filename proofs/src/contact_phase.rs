//! Any phase of a contact, from an arbitrary byte.

use touchstone_control::law::Contact;

/// The contact phase that a byte stands for, to make any phase from an arbitrary byte.
pub(crate) const fn contact_of(byte: u8) -> Contact {
    match byte % 3 {
        0 => Contact::Free,
        1 => Contact::First,
        _ => Contact::Augmenting,
    }
}
