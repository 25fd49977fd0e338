//! What a host says: typed ids, descriptions, edits, and the store that knows what is dirty.
