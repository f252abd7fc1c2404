//! Claims about the pictures and pages, held against parsed documents.
