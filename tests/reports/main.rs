//! Everything written: tables, figures, pages, and the committed report; and the order of the sources themselves.

mod committed_report;
mod committed_study;
mod fields;
mod figures;
mod files;
mod latex;
mod method_pages;
mod page;
mod report_data;
mod rooms;
mod tables;
mod verdicts;
